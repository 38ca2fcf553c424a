//! Text within HTML.

/// Text that can stand in an element or in a quoted attribute, in HTML and in XML.
///
/// Characters that XML forbids become U+FFFD.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\t' | '\n' => escaped.push(character),
            '\u{fffe}' | '\u{ffff}' => escaped.push('\u{fffd}'),
            other if other.is_control() => escaped.push('\u{fffd}'),
            other => escaped.push(other),
        }
    }
    escaped
}

/// JSON that can stand in a `script` element: no `<` that could end it, no `&`.
pub fn json_in_script(json: &str) -> String {
    // Neither character occurs in JSON outside of strings, where both may be escaped.
    json.replace('<', "\\u003c").replace('&', "\\u0026")
}

/// A `dt` and its `dd`; the description is HTML.
pub fn fact(term: &str, description: &str) -> String {
    format!("<div><dt>{}</dt><dd>{description}</dd></div>\n", escape(term))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_gets_through() {
        assert_eq!(escape("a <b> \"c\" & 'd'\u{0}"), "a &lt;b&gt; &quot;c&quot; &amp; &#39;d&#39;\u{fffd}");
        let json = json_in_script(&serde_json::to_string("</script><!-- &amp;").unwrap());
        assert!(!json.contains('<') && !json.contains('&'));
        assert_eq!(serde_json::from_str::<String>(&json).unwrap(), "</script><!-- &amp;");
    }
}
