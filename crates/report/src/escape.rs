//! Escapes text from files for the page.

use std::fmt::{self, Display, Formatter, Write};

/// Text escaped for content and quoted attributes. Characters that are not allowed in a document
/// become U+FFFD: control characters and noncharacters.
pub(crate) struct Escaped<'t>(pub(crate) &'t str);

impl Display for Escaped<'_> {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        for character in self.0.chars() {
            match character {
                '&' => formatter.write_str("&amp;")?,
                '<' => formatter.write_str("&lt;")?,
                '>' => formatter.write_str("&gt;")?,
                '"' => formatter.write_str("&quot;")?,
                '\'' => formatter.write_str("&#39;")?,
                '\n' | '\t' => formatter.write_char(character)?,
                // Overrides of the writing direction would make a name look different.
                '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => formatter.write_char('\u{fffd}')?,
                '\u{fffe}' | '\u{ffff}' => formatter.write_char('\u{fffd}')?,
                _ if character.is_control() => formatter.write_char('\u{fffd}')?,
                _ => formatter.write_char(character)?,
            }
        }
        Ok(())
    }
}

/// JSON for a data element: nothing in it ends the element, and it is also well-formed XML.
pub(crate) fn json_in_element(json: &str) -> String {
    json.replace('&', "\\u0026").replace('<', "\\u003c").replace('>', "\\u003e")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_text_ends_an_element_or_an_attribute() {
        let text = Escaped("</p><script>alert('\"')</script>&amp;\0\u{1b}[2J\u{202e}").to_string();
        assert!(!text.contains(['<', '>', '"', '\'', '\0', '\u{1b}', '\u{202e}']), "{text}");
        assert_eq!(text.matches('&').count(), 10, "each & begins an entity: {text}");
    }

    #[test]
    fn json_keeps_its_meaning() {
        let json = json_in_element(&serde_json::to_string("</script><!--&").unwrap());
        assert!(!json.contains('<'));
        assert_eq!(serde_json::from_str::<String>(&json).unwrap(), "</script><!--&");
    }
}
