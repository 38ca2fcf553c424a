//! Equations: a line of text becomes MathML, which browsers set without any library.
//!
//! Symbols are separated by spaces; `_` and `^` put the next one below and above, `{ }` make one of many, and `a over b` is a
//! fraction: `I ≈ { 1 } over { N } ∑ _ { i = 1 } ^ N f ( x _ i )`.

/// An equation on a line of its own.
pub fn display(source: &str) -> String {
    format!("<math display=\"block\">{}</math>", row(&mut source.split_whitespace(), None))
}

/// One within a sentence.
pub fn inline(source: &str) -> String {
    format!("<math>{}</math>", row(&mut source.split_whitespace(), None))
}

/// All up to the end of a group, as one element.
fn row<'a>(words: &mut impl Iterator<Item = &'a str>, end: Option<&str>) -> String {
    let mut parts: Vec<String> = Vec::new();
    while let Some(word) = words.next() {
        match word {
            word if Some(word) == end => break,
            "_" | "^" | "over" => {
                let base = parts.pop().unwrap_or_default();
                let next = atom(words);
                parts.push(join(word, &base, &next));
            }
            "{" => parts.push(row(words, Some("}"))),
            word => parts.push(leaf(word)),
        }
    }
    format!("<mrow>{}</mrow>", parts.concat())
}

fn atom<'a>(words: &mut impl Iterator<Item = &'a str>) -> String {
    match words.next() {
        Some("{") => row(words, Some("}")),
        Some(word) => leaf(word),
        None => String::from("<mrow></mrow>"),
    }
}

fn join(how: &str, base: &str, next: &str) -> String {
    let is_sum = base.contains('∑') && !base.starts_with("<mrow>");
    match (how, is_sum) {
        ("over", _) => format!("<mfrac>{base}{next}</mfrac>"),
        ("_", true) => format!("<munder>{base}{next}</munder>"),
        ("^", true) if base.starts_with("<munder>") => {
            let inner = base.trim_start_matches("<munder>").trim_end_matches("</munder>");
            format!("<munderover>{inner}{next}</munderover>")
        }
        ("_", false) => format!("<msub>{base}{next}</msub>"),
        _ => format!("<msup>{base}{next}</msup>"),
    }
}

fn leaf(word: &str) -> String {
    const OPERATORS: &str = "=+−·×/()[]|,∫∑→≈≤≥∝<>…";
    let escaped = word.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    let is = |test: fn(char) -> bool| word.chars().all(test);
    if is(|c| OPERATORS.contains(c)) {
        format!("<mo>{escaped}</mo>")
    } else if is(|c| c.is_ascii_digit() || c == '.') {
        format!("<mn>{escaped}</mn>")
    } else {
        format!("<mi>{escaped}</mi>")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_sums_and_indices() {
        assert_eq!(inline("a over 2"), "<math><mrow><mfrac><mi>a</mi><mn>2</mn></mfrac></mrow></math>");
        assert_eq!(
            inline("x _ i = y ^ { 2 }"),
            "<math><mrow><msub><mi>x</mi><mi>i</mi></msub><mo>=</mo><msup><mi>y</mi><mrow><mn>2</mn></mrow></msup></mrow></math>"
        );
        assert_eq!(
            inline("∑ _ i ^ N f"),
            "<math><mrow><munderover><mo>∑</mo><mi>i</mi><mi>N</mi></munderover><mi>f</mi></mrow></math>"
        );
    }
}
