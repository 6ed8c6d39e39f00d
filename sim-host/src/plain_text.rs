//! Text that comes from files and their names, for terminals and figures.

/// Signs that a terminal obeys and XML has no way to write stand as in TOML, `\u001B`; tabs and ends of lines stay.
pub fn written_out(text: &str) -> String {
    let forbidden = |sign: char| {
        sign.is_control() && !matches!(sign, '\t' | '\n') || matches!(sign, '\u{fffe}' | '\u{ffff}')
    };
    let mut out = String::new();
    for sign in text.chars() {
        if forbidden(sign) {
            out += &format!("\\u{:04X}", u32::from(sign));
        } else {
            out.push(sign);
        }
    }
    out
}
