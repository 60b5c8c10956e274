//! One line per component: the registry macro.
//!
//! A registry lists the kinds of one trait. The macro makes the enum of runtime objects (which
//! dereferences to the trait: the only `match` in the crate), the enum of file parameters, and what
//! the model file needs: the words for `kind`, deserialisation by word, JSON Schema by word.

/// Defines a registry of components.
///
/// Each line is `Variant("word", runtime type, parameter type)`. The parameter type implements
/// `Serialize + Deserialize + JsonSchema + Clone + PartialEq` and `build(&self, &Context)`.
#[macro_export]
macro_rules! registry {
    (
        $(#[$doc:meta])*
        pub enum $object:ident: dyn $trait:path, params $params:ident, context $context:ty, error $error:ty {
            $($variant:ident($word:literal, $runtime:ty, $file:ty)),+ $(,)?
        }
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone)]
        #[allow(missing_docs)]
        pub enum $object { $($variant($runtime)),+ }

        impl std::ops::Deref for $object {
            type Target = dyn $trait;
            #[inline]
            fn deref(&self) -> &Self::Target {
                match self { $(Self::$variant(object) => object),+ }
            }
        }

        /// The same components as written in a model file, in SI.
        #[derive(Debug, Clone, PartialEq)]
        #[allow(missing_docs)]
        pub enum $params { $($variant($file)),+ }

        impl $params {
            /// The words a model file can use for `kind`.
            pub const KINDS: &'static [&'static str] = &[$($word),+];

            /// The word of this component.
            pub fn kind(&self) -> &'static str {
                match self { $(Self::$variant(_) => $word),+ }
            }

            /// Reads the parameters of a `kind`; `None` for an unknown word.
            ///
            /// # Errors
            /// What the deserializer says.
            pub fn deserialize<'de, D: serde::Deserializer<'de>>(
                kind: &str,
                deserializer: D,
            ) -> Option<Result<Self, D::Error>> {
                match kind {
                    $($word => Some(
                        <$file as serde::Deserialize>::deserialize(deserializer).map(Self::$variant),
                    ),)+
                    _ => None,
                }
            }

            /// The parameters as a JSON object, in SI.
            pub fn to_value(&self) -> serde_json::Value {
                match self {
                    $(Self::$variant(params) => serde_json::to_value(params).unwrap_or_default()),+
                }
            }

            /// JSON Schema of the parameters of a `kind`; `None` for an unknown word.
            pub fn schema(kind: &str) -> Option<schemars::Schema> {
                match kind {
                    $($word => Some(schemars::schema_for!($file)),)+
                    _ => None,
                }
            }

            /// The runtime object.
            ///
            /// # Errors
            /// Names the field and the value that cannot be.
            pub fn build(&self, context: &$context) -> Result<$object, $error> {
                match self { $(Self::$variant(params) => params.build(context).map($object::$variant)),+ }
            }
        }
    };
}
