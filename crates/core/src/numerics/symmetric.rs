//! Eigenvalues and eigenvectors of a small symmetric matrix.
//!
//! **Numerics** cyclic Jacobi rotations: every entry beside the diagonal is turned to zero in turn until all of
//! them are below rounding. The vectors are orthogonal to rounding whatever the eigenvalues, also where they
//! are equal. The QR iteration of a library (nalgebra 0.35, tried) leaves a few 1e-9 of the heat of a building, where
//! balances are to close within 1e-9. **Sources** `golub2013`, section 8.5.

/// Sweeps after which rounding is all that is left: convergence is quadratic, ten are enough for any matrix
/// of this size.
const SWEEPS: usize = 40;

/// Eigenvalues, and eigenvectors as the columns of the second matrix, of the symmetric matrix `a`.
pub fn eigen<const N: usize>(mut a: [[f64; N]; N]) -> ([f64; N], [[f64; N]; N]) {
    let mut vectors = [[0.0; N]; N];
    for (i, row) in vectors.iter_mut().enumerate() {
        row[i] = 1.0;
    }
    for _ in 0..SWEEPS {
        let mut turned = false;
        for p in 0..N {
            for q in p + 1..N {
                let small = f64::EPSILON * f64::EPSILON * (a[p][p] * a[q][q]).abs();
                if a[p][q] == 0.0 || a[p][q] * a[p][q] <= small {
                    continue;
                }
                turned = true;
                let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
                let cos = 1.0 / t.hypot(1.0);
                rotate(&mut a, &mut vectors, (p, q), (cos, t * cos));
            }
        }
        if !turned {
            break;
        }
    }
    (std::array::from_fn(|i| a[i][i]), vectors)
}

/// Turns rows and columns p and q of the matrix, and the columns of the vectors.
// Rows p and q are changed together, column by column.
#[allow(clippy::needless_range_loop)]
fn rotate<const N: usize>(
    a: &mut [[f64; N]; N],
    vectors: &mut [[f64; N]; N],
    (p, q): (usize, usize),
    (cos, sin): (f64, f64),
) {
    for row in a.iter_mut().chain(vectors) {
        (row[p], row[q]) = (cos * row[p] - sin * row[q], sin * row[p] + cos * row[q]);
    }
    for column in 0..N {
        let (above, below) = (a[p][column], a[q][column]);
        a[p][column] = cos * above - sin * below;
        a[q][column] = sin * above + cos * below;
    }
    (a[p][q], a[q][p]) = (0.0, 0.0);
}

#[cfg(test)]
#[allow(clippy::needless_range_loop)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        // [[2, 1], [1, 2]]: 1 with (1, -1)/sqrt(2), 3 with (1, 1)/sqrt(2).
        let (values, vectors) = eigen([[2.0, 1.0], [1.0, 2.0]]);
        let mut sorted = values;
        sorted.sort_by(f64::total_cmp);
        assert!((sorted[0] - 1.0).abs() < 1e-15 && (sorted[1] - 3.0).abs() < 1e-15, "{values:?}");
        assert!((vectors[0][0].abs() - 0.5_f64.sqrt()).abs() < 1e-15, "{vectors:?}");
        // Nothing to do, and a matrix of zeros.
        assert_eq!(eigen([[5.0, 0.0], [0.0, -1.0]]).0, [5.0, -1.0]);
        assert_eq!(eigen([[0.0; 3]; 3]).0, [0.0; 3]);
    }

    #[test]
    fn vectors_are_orthogonal_and_give_the_matrix_back() {
        // Entries over eight orders of magnitude, two of the eigenvalues nearly equal.
        let mut a = [[0.0_f64; 5]; 5];
        for (i, scale) in [1e-8, 1e-5, 1e-3, 1.0, 1.0 + 1e-12].iter().enumerate() {
            a[i][i] = *scale;
            for k in 0..i {
                a[i][k] =
                    0.3 * (*scale * a[k][k]).sqrt() * if (i + k) % 2 == 0 { 1.0 } else { -0.5 };
                a[k][i] = a[i][k];
            }
        }
        let (values, vectors) = eigen(a);
        for i in 0..5 {
            for k in 0..5 {
                let product: f64 = (0..5).map(|m| vectors[m][i] * vectors[m][k]).sum();
                let wanted = if i == k { 1.0 } else { 0.0 };
                assert!((product - wanted).abs() < 1e-14, "{i} {k}: {product}");
                let again: f64 = (0..5).map(|m| vectors[i][m] * values[m] * vectors[k][m]).sum();
                assert!((again - a[i][k]).abs() < 1e-14, "{i} {k}: {again} instead of {}", a[i][k]);
            }
        }
        assert!(values.iter().all(|value| *value > 0.0), "{values:?}");
    }
}
