//! What stands on the page in both of its languages.

/// The languages of the page, as `lang` attributes have them.
pub const LANGUAGES: [&str; 2] = ["en", "es"];

/// A text in English and in Spanish: HTML, but for the texts of pictures, which are plain.
#[derive(Clone, Debug)]
pub struct Text {
    /// English.
    pub en: String,
    /// Spanish.
    pub es: String,
}

/// A text in both languages.
pub fn text(en: impl Into<String>, es: impl Into<String>) -> Text {
    Text { en: en.into(), es: es.into() }
}

/// What is written alike in both: names and numbers.
pub fn same(both: impl Into<String>) -> Text {
    let en: String = both.into();
    Text { es: en.clone(), en }
}

impl Text {
    /// Each language with its `lang` attribute.
    pub fn both(&self) -> [(&'static str, &str); 2] {
        [(LANGUAGES[0], &self.en), (LANGUAGES[1], &self.es)]
    }

    /// Both languages, each changed in the same way.
    pub fn map(&self, change: impl Fn(&str) -> String) -> Self {
        Self { en: change(&self.en), es: change(&self.es) }
    }

    /// Both within an element: once where they are alike, else one for each language.
    pub fn within(&self, element: &str) -> String {
        let (name, attributes) = element.split_once(' ').map_or((element, ""), |(name, rest)| (name, rest));
        let space = if attributes.is_empty() { "" } else { " " };
        if self.en == self.es {
            return format!("<{name}{space}{attributes}>{}</{name}>", self.en);
        }
        let all = self.both().map(|(lang, text)| format!("<{name}{space}{attributes} lang=\"{lang}\">{text}</{name}>"));
        all.concat()
    }

    /// Both within a line of text.
    pub fn inline(&self) -> String {
        if self.en == self.es { self.en.clone() } else { self.within("span") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_language_has_an_element_of_its_own() {
        assert_eq!(text("a", "b").within("p"), "<p lang=\"en\">a</p><p lang=\"es\">b</p>");
        assert_eq!(same("7").within("td class=\"x\""), "<td class=\"x\">7</td>");
        assert_eq!(same("7").inline(), "7");
    }
}
