//! Subscripts in the labels of an SVG.

/// Turns `e_x` in the text of an SVG into an e with a lowered, smaller x.
///
/// The plot library knows plain text only, and Unicode has no subscript y or θ. The shift is a
/// `dy`, which every viewer and resvg understand, unlike `baseline-shift`.
pub fn subscripts(svg: &str) -> String {
    let mut out = String::with_capacity(svg.len() + svg.len() / 50);
    let mut rest = svg;
    // Text is what stands between '>' and '<'; attributes have no business with us.
    while let Some(open) = rest.find('>') {
        let (tag, after) = rest.split_at(open + 1);
        out.push_str(tag);
        let end = after.find('<').unwrap_or(after.len());
        let (text, next) = after.split_at(end);
        lower(text, &mut out);
        rest = next;
    }
    out.push_str(rest);
    out
}

fn lower(text: &str, out: &mut String) {
    let mut rest = text;
    while let Some(at) = rest.find('_') {
        let (before, after) = rest.split_at(at);
        let after = &after[1..];
        let length = after
            .find(|c: char| !c.is_alphanumeric())
            .unwrap_or(after.len());
        let (subscript, next) = after.split_at(length);
        out.push_str(before);
        out.push_str("<tspan dy=\"0.3em\" font-size=\"72%\">");
        out.push_str(subscript);
        out.push_str("</tspan>");
        rest = next;
        if !rest.is_empty() {
            // Back up: 0.3 of the smaller size is 0.216 of this one.
            out.push_str("<tspan dy=\"-0.216em\">");
            lower(rest, out);
            out.push_str("</tspan>");
            return;
        }
    }
    out.push_str(rest);
}

#[cfg(test)]
mod tests {
    use super::subscripts;

    #[test]
    fn only_text_is_touched() {
        let svg = "<text id=\"a_b\">e_x [m]</text><g/>";
        let set = subscripts(svg);
        assert!(set.starts_with("<text id=\"a_b\">e<tspan dy"), "{set}");
        assert!(set.ends_with("> [m]</tspan></text><g/>"), "{set}");
    }
}
