//! Sums of rows of complex numbers, real and imaginary parts apart, on the vectors of the processor (`pulp`).
//!
//! **Numerics** a product and its addition are rounded once. All that works on vectors has to be inlined where they are
//! chosen: a closure is not, once it is called by value.

use nalgebra::Complex;
use pulp::{Arch, NullaryFnOnce, Simd, WithSimd};

type C64 = Complex<f64>;

/// A part of a row, or a row: real and imaginary parts.
pub(super) type Row<'a> = (&'a [f64], &'a [f64]);
pub(super) type RowMut<'a> = (&'a mut [f64], &'a mut [f64]);

/// Numbers that are worked on at once.
pub(super) const LANES: usize = 4;

/// `own += share other`.
pub(super) fn more(share: C64, other: Row, own: RowMut) {
    add_rows(&[share], other, own);
}

/// `own += sum of share row`, of rows one behind the other.
pub(super) fn add_rows(shares: &[C64], rows: Row, own: RowMut) {
    Arch::new().dispatch(AddRows { shares, rows, own });
}

struct AddRows<'a> {
    shares: &'a [C64],
    rows: Row<'a>,
    own: RowMut<'a>,
}

impl WithSimd for AddRows<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { shares, rows: (re, im), own: (own_re, own_im) } = self;
        let width = own_re.len().max(1);
        let rows = re.chunks_exact(width).zip(im.chunks_exact(width));
        for (share, row) in shares.iter().zip(rows) {
            add(simd, *share, row, (own_re, own_im));
        }
    }
}

/// Takes row `k` of a matrix, whose rows have some width, off the rows below it within the panel of column `k`, and with the
/// last row of the panel all its rows off what is right of it; `inverse` is one over the pivot.
pub(super) fn take_off(matrix: RowMut, width: usize, k: usize, inverse: C64) {
    Arch::new().dispatch(TakeOff { matrix, width, k, inverse });
}

struct TakeOff<'a> {
    matrix: RowMut<'a>,
    width: usize,
    k: usize,
    inverse: C64,
}

impl WithSimd for TakeOff<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { matrix: (re, im), width, k, inverse } = self;
        let (first, behind) = (k - k % LANES, k - k % LANES + LANES);
        let (upper_re, lower_re) = re.split_at_mut((k + 1) * width);
        let (upper_im, lower_im) = im.split_at_mut((k + 1) * width);
        // Of the panel, with zeros in place of the columns that are done.
        let (mut row_re, mut row_im) = ([0.0; LANES], [0.0; LANES]);
        let (left, done) = (k * width + k + 1..k * width + behind, k + 1 - first);
        row_re[done..].copy_from_slice(&upper_re[left.clone()]);
        row_im[done..].copy_from_slice(&upper_im[left]);
        let lower = lower_re.chunks_exact_mut(width).zip(lower_im.chunks_exact_mut(width));
        for (re, im) in lower {
            let share = C64::new(re[k], im[k]) * inverse;
            let own = (&mut re[first..behind], &mut im[first..behind]);
            add(simd, -share, (&row_re, &row_im), own);
            // Last: a vector that was just written in part is read slowly.
            (re[k], im[k]) = (share.re, share.im);
        }
        if k + 1 < behind || behind >= width {
            return;
        }
        // Right of the panel: first its own rows, then all below.
        let panel = first * width..behind * width;
        let (upper_re, lower_re) = re[panel.start..].split_at_mut(panel.len());
        let (upper_im, lower_im) = im[panel.start..].split_at_mut(panel.len());
        for i in 1..LANES {
            let (known_re, own_re) = upper_re.split_at_mut(i * width);
            let (known_im, own_im) = upper_im.split_at_mut(i * width);
            for l in 0..i {
                let share = C64::new(own_re[first + l], own_im[first + l]);
                let right = l * width + behind..(l + 1) * width;
                let own = (&mut own_re[behind..width], &mut own_im[behind..width]);
                add(simd, -share, (&known_re[right.clone()], &known_im[right]), own);
            }
        }
        let rows: [Row; LANES] = std::array::from_fn(
            #[inline(always)]
            |l| {
                let right = l * width + behind..(l + 1) * width;
                (&upper_re[right.clone()], &upper_im[right])
            },
        );
        for (re, im) in lower_re.chunks_exact_mut(width).zip(lower_im.chunks_exact_mut(width)) {
            let (done_re, own_re) = re.split_at_mut(behind);
            let (done_im, own_im) = im.split_at_mut(behind);
            let (shares_re, shares_im) = (&done_re[first..], &done_im[first..]);
            let shares: [C64; LANES] = std::array::from_fn(
                #[inline(always)]
                |l| C64::new(-shares_re[l], -shares_im[l]),
            );
            add_four(simd, shares, rows, (own_re, own_im));
        }
    }
}

/// `own += share other`.
#[inline(always)]
fn add<S: Simd>(simd: S, share: C64, other: Row, (own_re, own_im): RowMut) {
    let (other_re, other_rest_re) = S::as_simd_f64s(other.0);
    let (other_im, other_rest_im) = S::as_simd_f64s(other.1);
    let (own_re, own_rest_re) = S::as_mut_simd_f64s(own_re);
    let (own_im, own_rest_im) = S::as_mut_simd_f64s(own_im);
    let parts = splat(simd, share);
    let other = other_re.iter().zip(other_im);
    for ((x, y), (a, b)) in own_re.iter_mut().zip(own_im).zip(other) {
        *x = simd.mul_add_f64s(parts.2, *b, simd.mul_add_f64s(parts.0, *a, *x));
        *y = simd.mul_add_f64s(parts.1, *a, simd.mul_add_f64s(parts.0, *b, *y));
    }
    let other = other_rest_re.iter().zip(other_rest_im);
    for ((x, y), (a, b)) in own_rest_re.iter_mut().zip(own_rest_im).zip(other) {
        *x = (-share.im).mul_add(*b, share.re.mul_add(*a, *x));
        *y = share.im.mul_add(*a, share.re.mul_add(*b, *y));
    }
}

/// Real part, imaginary part and its opposite, each in all lanes.
#[inline(always)]
fn splat<S: Simd>(simd: S, share: C64) -> (S::f64s, S::f64s, S::f64s) {
    (simd.splat_f64s(share.re), simd.splat_f64s(share.im), simd.splat_f64s(-share.im))
}

/// `own += sum of share row`.
#[inline(always)]
fn add_four<'a, S: Simd>(simd: S, shares: [C64; LANES], rows: [Row<'a>; LANES], (re, im): RowMut) {
    let (own_re, rest) = S::as_mut_simd_f64s(re);
    let vectors = own_re.len();
    if !rest.is_empty() {
        for (share, row) in shares.into_iter().zip(rows) {
            add(simd, share, row, (&mut *re, &mut *im));
        }
        return;
    }
    let (own_im, _) = S::as_mut_simd_f64s(im);
    let parts = [
        splat(simd, shares[0]),
        splat(simd, shares[1]),
        splat(simd, shares[2]),
        splat(simd, shares[3]),
    ];
    let whole = |part: &'a [f64]| &S::as_simd_f64s(part).0[..vectors];
    let rows = rows.map(|(re, im)| (whole(re), whole(im)));
    for (i, (x, y)) in own_re.iter_mut().zip(own_im).enumerate() {
        let (mut re, mut im) = (*x, *y);
        for l in 0..LANES {
            let (a, b, share) = (rows[l].0[i], rows[l].1[i], &parts[l]);
            re = simd.mul_add_f64s(share.2, b, simd.mul_add_f64s(share.0, a, re));
            im = simd.mul_add_f64s(share.1, a, simd.mul_add_f64s(share.0, b, im));
        }
        (*x, *y) = (re, im);
    }
}

/// Work that is inlined where it is called, which a closure is not once it is called by value.
struct Inlined<F>(F);

impl<R, F: FnMut() -> R> NullaryFnOnce for Inlined<F> {
    type Output = R;

    #[inline(always)]
    fn call(mut self) -> R {
        (self.0)()
    }
}

/// Does something with all that is inlined in it compiled for the vectors of the processor.
pub(super) fn in_vectors<R>(work: impl FnMut() -> R) -> R {
    Arch::new().dispatch(Inlined(work))
}
