//! JSON arrays of samples, with the line of every sample and the path of every field.

use super::refusal::{Place, Reason, Refusal};
use super::{Format, MAX_SAMPLES};
use serde::Deserialize;
use serde::de::{DeserializeOwned, Deserializer, Error, SeqAccess, Visitor};
use serde_json::value::RawValue;
use std::fmt;

/// The text of every element of an array; not more than [`MAX_SAMPLES`].
pub(super) struct Elements<'a>(pub(super) Vec<&'a RawValue>);

/// Begins the message of the error that stops the reading of a long array.
const TOO_MANY: &str = "too many samples";

impl<'de: 'a, 'a> Deserialize<'de> for Elements<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Collect;
        impl<'de> Visitor<'de> for Collect {
            type Value = Elements<'de>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an array of samples")
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
                let mut elements = Vec::new();
                while let Some(element) = seq.next_element()? {
                    if elements.len() == MAX_SAMPLES {
                        return Err(A::Error::custom(TOO_MANY));
                    }
                    elements.push(element);
                }
                Ok(Elements(elements))
            }
        }
        deserializer.deserialize_seq(Collect)
    }
}

/// A whole document, with errors by line and path.
pub(super) fn document<'a, T: Deserialize<'a>>(
    format: Format,
    text: &'a str,
) -> Result<T, Refusal> {
    let mut json = serde_json::Deserializer::from_str(text);
    let parsed = serde_path_to_error::deserialize(&mut json).map_err(|e| {
        let path = e.path().to_string();
        let inner = e.into_inner();
        if inner.to_string().starts_with(TOO_MANY) {
            let reason = Reason::TooManySamples { limit: MAX_SAMPLES };
            return Refusal::new(format, Place::line(inner.line()), reason);
        }
        refusal(format, Place::line(inner.line()), &path, &inner)
    })?;
    json.end()
        .map_err(|e| refusal(format, Place::line(e.line()), ".", &e))?;
    Ok(parsed)
}

/// The samples of an array, each with its place.
pub(super) fn samples<T: DeserializeOwned>(
    format: Format,
    text: &str,
    elements: &Elements<'_>,
) -> Result<Vec<(Place, T)>, Refusal> {
    let mut line = 1;
    let mut offset = 0;
    let mut parsed = Vec::with_capacity(elements.0.len());
    for (index, element) in elements.0.iter().enumerate() {
        let element = element.get();
        // The element is a part of the text: its address tells where.
        let start = (element.as_ptr() as usize)
            .wrapping_sub(text.as_ptr() as usize)
            .min(text.len());
        let skipped = text.as_bytes().get(offset..start).unwrap_or_default();
        line += skipped.iter().filter(|&&b| b == b'\n').count();
        offset = start;
        let mut json = serde_json::Deserializer::from_str(element);
        let sample = serde_path_to_error::deserialize(&mut json).map_err(|e| {
            let path = e.path().to_string();
            let inner = e.into_inner();
            let place = Place::sample(line + inner.line().saturating_sub(1), index);
            refusal(format, place, &path, &inner)
        })?;
        parsed.push((Place::sample(line, index), sample));
    }
    Ok(parsed)
}

/// A refusal from serde's error; its own "at line" is dropped, the place has it.
fn refusal(format: Format, place: Place, path: &str, error: &serde_json::Error) -> Refusal {
    let message = error.to_string();
    let message = message
        .rsplit_once(" at line ")
        .map_or(message.as_str(), |(head, _)| head);
    let message = format!("{message} (column {})", error.column());
    let place = match path {
        "." | "?" => place,
        path => place.field(path.trim_end_matches(".?")),
    };
    Refusal::new(format, place, Reason::Malformed(message))
}

/// A number that may be null, absent, or a string such as `"NaN"`: then nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Lenient(pub(super) Option<f64>);

impl<'de> Deserialize<'de> for Lenient {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Any<'a> {
            Number(f64),
            Text(#[serde(borrow)] std::borrow::Cow<'a, str>),
            Null,
        }
        match Any::deserialize(deserializer) {
            Ok(Any::Number(value)) => Ok(Self(Some(value).filter(|v| v.is_finite()))),
            Ok(Any::Null) => Ok(Self(None)),
            Ok(Any::Text(text)) => match text.parse::<f64>() {
                Ok(value) => Ok(Self(Some(value).filter(|v| v.is_finite()))),
                Err(_) => Err(Error::custom(format_args!(
                    "`{}` is not a number",
                    text.chars().take(40).collect::<String>()
                ))),
            },
            Err(_) => Err(Error::custom("expected a number")),
        }
    }
}
