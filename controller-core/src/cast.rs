//! The same value in another precision, for types that hold numbers.

/// Gives a type `cast`: its fields are cast, but for those that it `keeps`, which hold no number.
macro_rules! cast {
    ($name:ident { $($field:ident),+ $(,)? } $(keeps $($kept:ident),+)?) => {
        impl<T: $crate::scalar::Scalar> $name<T> {
            /// The same in another precision: each number is rounded to nearest, and exact where it widens.
            pub fn cast<S: $crate::scalar::Scalar>(&self) -> $name<S> {
                $name {
                    $($field: self.$field.cast(),)+
                    $($($kept: self.$kept,)+)?
                }
            }
        }
    };
}

pub(crate) use cast;
