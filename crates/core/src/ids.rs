//! Typed indices: a node can never be used where an edge is meant.

use serde::{Deserialize, Serialize};

macro_rules! index_newtype {
    ($($(#[$doc:meta])* $name:ident),+ $(,)?) => {$(
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        pub struct $name(pub u32);

        impl $name {
            /// The index as `usize`, for slices.
            #[inline]
            pub const fn index(self) -> usize {
                self.0 as usize
            }

            /// The id of a slice index.
            ///
            /// # Panics
            /// Above `u32::MAX` elements, which no network reaches.
            #[inline]
            pub fn from_index(index: usize) -> Self {
                assert!(index <= u32::MAX as usize, "more than u32::MAX components");
                Self(index as u32)
            }
        }
    )+};
}

index_newtype! {
    /// A node of the network: one pressure, one temperature.
    NodeId,
    /// An edge of the network: one mass flow, positive from its port a to its port b.
    EdgeId,
    /// An input signal (command, boundary value) of the signal table.
    SignalId,
    /// A thermal unit behind a hydraulic interface.
    UnitId,
    /// A recorded channel.
    ChannelId,
}
