//! A value as Rust source, by the names that its type gives to serde.
//!
//! Renamed variants get their names back (`after_us` is `AfterUs`), numbers keep their bits, and lines stand as rustfmt
//! leaves them. What parameters do not have (text, maps, tuples) is an error.

use serde::ser::{Error as _, Impossible, Serialize, SerializeStruct, Serializer};
use std::fmt;

/// A value that has no literal here.
#[derive(Debug, thiserror::Error)]
#[error("no constant: {0}")]
pub struct NoLiteral(String);

impl serde::ser::Error for NoLiteral {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self(message.to_string())
    }
}

/// The literal of a value, at no depth.
///
/// # Errors
/// [`NoLiteral`].
pub fn literal(value: &impl Serialize) -> Result<String, NoLiteral> {
    value.serialize(Literal { depth: 0 })
}

#[derive(Clone, Copy)]
struct Literal {
    depth: usize,
}

/// A struct whose fields are being written.
struct Fields {
    depth: usize,
    name: &'static str,
    fields: Vec<(&'static str, String)>,
}

/// The shortest text that gives the same bits back.
fn number(value: f32) -> String {
    if value.is_finite() {
        format!("{value:?}")
    } else if value.is_nan() {
        "f32::NAN".to_owned()
    } else if value > 0.0 {
        "f32::INFINITY".to_owned()
    } else {
        "f32::NEG_INFINITY".to_owned()
    }
}

/// Digits in threes.
pub(super) fn whole(value: u32) -> String {
    let digits = value.to_string();
    let mut text = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            text.push('_');
        }
        text.push(digit);
    }
    text
}

/// The variant's name in Rust: serde has some in kebab or snake case.
fn variant_name(name: &str) -> String {
    let words = name.split(['-', '_']);
    let capital = |word: &str| {
        let mut letters = word.chars();
        let first = letters
            .next()
            .map(|letter| letter.to_ascii_uppercase())
            .into_iter();
        first.chain(letters).collect::<String>()
    };
    words.map(capital).collect()
}

impl SerializeStruct for Fields {
    type Ok = String;
    type Error = NoLiteral;

    fn serialize_field<T: Serialize + ?Sized>(
        &mut self,
        name: &'static str,
        value: &T,
    ) -> Result<(), NoLiteral> {
        let depth = self.depth + 1;
        self.fields
            .push((name, value.serialize(Literal { depth })?));
        Ok(())
    }

    fn end(self) -> Result<String, NoLiteral> {
        // The one pair that has constructors, and stands in a table of its own.
        if let ("Response", [("reaction", reaction), ("latch", latch)]) = (self.name, &*self.fields)
        {
            let how = if latch == "true" {
                "latched"
            } else {
                "passing"
            };
            return Ok(format!("Response::{how}({reaction})"));
        }
        let inner = "    ".repeat(self.depth + 1);
        let mut text = format!("{} {{\n", self.name);
        for (name, value) in &self.fields {
            text.push_str(&format!("{inner}{name}: {value},\n"));
        }
        text.push_str(&"    ".repeat(self.depth));
        text.push('}');
        Ok(text)
    }
}

/// What no parameter is.
macro_rules! refuse {
    ($($method:ident($($type:ty),*);)*) => {
        $(fn $method(self, $(_: $type),*) -> Result<String, NoLiteral> {
            Err(NoLiteral::custom(stringify!($method)))
        })*
    };
}

impl Serializer for Literal {
    type Ok = String;
    type Error = NoLiteral;
    type SerializeSeq = Impossible<String, NoLiteral>;
    type SerializeTuple = Impossible<String, NoLiteral>;
    type SerializeTupleStruct = Impossible<String, NoLiteral>;
    type SerializeTupleVariant = Impossible<String, NoLiteral>;
    type SerializeMap = Impossible<String, NoLiteral>;
    type SerializeStruct = Fields;
    type SerializeStructVariant = Impossible<String, NoLiteral>;

    fn serialize_bool(self, value: bool) -> Result<String, NoLiteral> {
        Ok(value.to_string())
    }

    fn serialize_f32(self, value: f32) -> Result<String, NoLiteral> {
        Ok(number(value))
    }

    fn serialize_u8(self, value: u8) -> Result<String, NoLiteral> {
        Ok(whole(value.into()))
    }

    fn serialize_u16(self, value: u16) -> Result<String, NoLiteral> {
        Ok(whole(value.into()))
    }

    fn serialize_u32(self, value: u32) -> Result<String, NoLiteral> {
        Ok(whole(value))
    }

    fn serialize_none(self) -> Result<String, NoLiteral> {
        Ok("None".to_owned())
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<String, NoLiteral> {
        Ok(format!("Some({})", value.serialize(self)?))
    }

    fn serialize_unit_variant(
        self,
        name: &'static str,
        _: u32,
        variant: &'static str,
    ) -> Result<String, NoLiteral> {
        Ok(format!("{name}::{}", variant_name(variant)))
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        name: &'static str,
        _: u32,
        variant: &'static str,
        value: &T,
    ) -> Result<String, NoLiteral> {
        let value = value.serialize(self)?;
        Ok(format!("{name}::{}({value})", variant_name(variant)))
    }

    fn serialize_struct(self, name: &'static str, len: usize) -> Result<Fields, NoLiteral> {
        Ok(Fields {
            depth: self.depth,
            name,
            fields: Vec::with_capacity(len),
        })
    }

    refuse! {
        serialize_i8(i8);
        serialize_i16(i16);
        serialize_i32(i32);
        serialize_i64(i64);
        serialize_u64(u64);
        serialize_f64(f64);
        serialize_char(char);
        serialize_str(&str);
        serialize_bytes(&[u8]);
        serialize_unit();
        serialize_unit_struct(&'static str);
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(
        self,
        name: &'static str,
        _: &T,
    ) -> Result<String, NoLiteral> {
        Err(NoLiteral::custom(name))
    }

    fn serialize_seq(self, _: Option<usize>) -> Result<Self::SerializeSeq, NoLiteral> {
        Err(NoLiteral::custom("a sequence"))
    }

    fn serialize_tuple(self, _: usize) -> Result<Self::SerializeTuple, NoLiteral> {
        Err(NoLiteral::custom("a tuple"))
    }

    fn serialize_tuple_struct(
        self,
        name: &'static str,
        _: usize,
    ) -> Result<Self::SerializeTupleStruct, NoLiteral> {
        Err(NoLiteral::custom(name))
    }

    fn serialize_tuple_variant(
        self,
        name: &'static str,
        _: u32,
        _: &'static str,
        _: usize,
    ) -> Result<Self::SerializeTupleVariant, NoLiteral> {
        Err(NoLiteral::custom(name))
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Self::SerializeMap, NoLiteral> {
        Err(NoLiteral::custom("a map"))
    }

    fn serialize_struct_variant(
        self,
        name: &'static str,
        _: u32,
        _: &'static str,
        _: usize,
    ) -> Result<Self::SerializeStructVariant, NoLiteral> {
        Err(NoLiteral::custom(name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Serialize;

    #[test]
    fn numbers_come_back_with_the_same_bits() {
        for value in [0.1, -0.0, 1.0e-5, 3.0e30, 16_777_217.0, f32::MIN_POSITIVE] {
            let back: f32 = number(value).parse().expect("a number");
            assert_eq!(back.to_bits(), value.to_bits());
            assert!(number(value).contains(['.', 'e']), "{value} is a float");
        }
    }

    #[test]
    fn whole_numbers_are_grouped() {
        let grouped = [0, 999, 1_000, 1_234_567].map(whole);
        assert_eq!(grouped, ["0", "999", "1_000", "1_234_567"]);
    }

    #[derive(Serialize)]
    #[serde(rename_all = "kebab-case")]
    enum Kind {
        TurnFirst,
        AfterUs(u32),
    }

    #[derive(Serialize)]
    struct Inner {
        kind: Kind,
    }

    #[derive(Serialize)]
    struct Outer {
        number: f32,
        inner: Option<Inner>,
        none: Option<Inner>,
        timeout: Kind,
    }

    #[test]
    fn structs_stand_as_rustfmt_leaves_them_and_variants_have_their_names() {
        let value = Outer {
            number: f32::INFINITY,
            inner: Some(Inner {
                kind: Kind::TurnFirst,
            }),
            none: None,
            timeout: Kind::AfterUs(10_000),
        };
        let text = "Outer {\n    number: f32::INFINITY,\n    inner: Some(Inner {\n        kind: Kind::TurnFirst,\n    \
                    }),\n    none: None,\n    timeout: Kind::AfterUs(10_000),\n}";
        assert_eq!(literal(&value).expect("a literal"), text);
        assert!(literal(&"text").is_err() && literal(&[1_u8]).is_err());
    }
}
