//! A robot's file, for `tune`, `verify` and `constants`.

use super::error::CommandError;
use sim_host::mission::BaseSpec;
use sim_host::scenario::BuiltInBase;
use std::path::Path;

/// A base with the text that describes it.
pub struct Robot {
    /// File name without its extension.
    pub name: String,
    /// File name.
    pub file: String,
    /// The file.
    pub text: String,
    /// What it says.
    pub base: BaseSpec,
}

impl Robot {
    /// A file if there is one, else a built-in base of that name.
    pub fn load(path: &Path) -> Result<Self, CommandError> {
        let part = |part: Option<&std::ffi::OsStr>| {
            part.map_or_else(String::new, |part| part.to_string_lossy().into_owned())
        };
        let built_in = path.to_str().and_then(BuiltInBase::find);
        if let Some(built_in) = built_in.filter(|_| !path.exists()) {
            return Ok(Self {
                name: built_in.name.to_owned(),
                file: format!("{}.toml", built_in.name),
                text: built_in.text.to_owned(),
                base: built_in.base()?,
            });
        }
        let text = std::fs::read_to_string(path).map_err(|cause| CommandError::Read {
            path: path.to_owned(),
            cause,
        })?;
        let base = BaseSpec::parse(&path.display().to_string(), &text)?;
        super::note(&base);
        Ok(Self {
            name: part(path.file_stem()),
            file: part(path.file_name()),
            base,
            text,
        })
    }
}
