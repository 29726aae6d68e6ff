//! Parses comments `#@mkillum`.

/// The selection of surfaces that become lights.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Selected {
    All,
    Nothing,
    /// The surfaces with a modifier.
    Only(String),
    /// All except those with a modifier.
    Except(String),
}

impl Selected {
    pub(super) fn has(&self, modifier: &str) -> bool {
        match self {
            Selected::All => true,
            Selected::Nothing => false,
            Selected::Only(name) => name == modifier,
            Selected::Except(name) => name != modifier,
        }
    }
}

/// The treatment of colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Colors {
    /// Lights are grey.
    Nothing,
    /// The mean colour of each light.
    Mean,
    /// The colour of each direction.
    Spread,
}

/// The material type of the new lights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Becomes {
    Illum,
    Light,
}

/// The options of the following surfaces.
#[derive(Clone, Debug)]
pub(super) struct Parameters {
    pub(super) material: String,
    pub(super) data_file: String,
    /// The number of the next data file; 0 is not written.
    pub(super) data_number: u32,
    /// Whether the data file is named explicitly, so that an existing one may be replaced.
    pub(super) replaces_data: bool,
    pub(super) selected: Selected,
    pub(super) colors: Colors,
    /// Directions per projected steradian; 0 for uniform emission.
    pub(super) density: u32,
    /// Rays per direction.
    pub(super) samples: u32,
    /// Surfaces with less radiance stay unchanged, W/(sr·m²).
    pub(super) least_brightness: f64,
    pub(super) becomes: Becomes,
}

impl Default for Parameters {
    fn default() -> Self {
        Parameters {
            material: "illum_mat".to_owned(),
            data_file: "illum".to_owned(),
            data_number: 0,
            replaces_data: false,
            selected: Selected::All,
            colors: Colors::Nothing,
            density: 48,
            samples: 32,
            least_brightness: 0.0,
            becomes: Becomes::Illum,
        }
    }
}

/// Further results of parsing a comment.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct CommentResult {
    /// The output file of all that follows.
    pub(super) output: Option<String>,
    /// The new name of data files, if it changes.
    pub(super) names_data: Option<String>,
    /// Whether the text is output of this program; the rest of the comment is then ignored.
    pub(super) is_processed: bool,
    /// Unknown words.
    pub(super) unknown: Vec<String>,
}

impl Parameters {
    /// Parses the words of a comment.
    pub(super) fn read(&mut self, text: &str) -> CommentResult {
        let mut result = CommentResult::default();
        let before = self.data_file.clone();
        for word in text.split_ascii_whitespace() {
            if word.starts_with('!') {
                self.selected = Selected::Nothing;
                result.is_processed = true;
                return result;
            }
            match word.strip_prefix("o=").filter(|file| !file.is_empty()) {
                Some(file) => result.output = Some(file.to_owned()),
                None if self.take(word).is_some() => {}
                None => result.unknown.push(word.to_owned()),
            }
        }
        result.names_data = Some(self.data_file.clone()).filter(|name| *name != before);
        result
    }

    /// Parses one word; `None` if it is unknown.
    fn take(&mut self, word: &str) -> Option<()> {
        match word {
            "l+" => self.becomes = Becomes::Light,
            "l-" => self.becomes = Becomes::Illum,
            // As in Radiance, only the first letter is significant.
            _ if word.starts_with('a') => self.selected = Selected::All,
            _ if word.starts_with('n') => self.selected = Selected::Nothing,
            _ => {
                let (name, value) = word.split_once('=')?;
                return self.set(name, value);
            }
        }
        Some(())
    }

    fn set(&mut self, name: &str, value: &str) -> Option<()> {
        let some = || Some(value).filter(|value| !value.is_empty());
        match name {
            "m" => {
                self.material = some()?.to_owned();
                if !self.replaces_data {
                    self.name_data(value);
                }
            }
            "f" => {
                self.replaces_data = !value.is_empty();
                let name = some().map_or_else(|| self.material.clone(), str::to_owned);
                self.name_data(&name);
            }
            "i" => self.selected = Selected::Only(value.to_owned()),
            "e" => self.selected = Selected::Except(value.to_owned()),
            "c" => {
                self.colors = match value.chars().next()? {
                    'a' => Colors::Mean,
                    'd' => Colors::Spread,
                    'n' => Colors::Nothing,
                    _ => return None,
                }
            }
            "d" if value.is_empty() => {}
            "d" => self.density = whole(value)?,
            "s" => self.samples = whole(value)?,
            "b" => self.least_brightness = value.parse::<f64>().ok().filter(|value| value.is_finite())?.max(0.0),
            _ => return None,
        }
        Some(())
    }

    fn name_data(&mut self, name: &str) {
        name.clone_into(&mut self.data_file);
        self.data_number = 0;
    }
}

/// A non-negative integer; negative numbers become zero.
fn whole(word: &str) -> Option<u32> {
    let number: i64 = word.parse().ok()?;
    Some(u32::try_from(number.max(0)).unwrap_or(u32::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_say_what_surfaces_become() {
        let mut parameters = Parameters::default();
        let result = parameters.read(" m=win c=d d=20 s=8\tl+ b=.5 i=glazing o=out.rad");
        assert_eq!((result.output.as_deref(), result.unknown.len()), (Some("out.rad"), 0));
        assert_eq!((parameters.material.as_str(), parameters.data_file.as_str()), ("win", "win"));
        assert_eq!((parameters.density, parameters.samples, parameters.least_brightness), (20, 8, 0.5));
        assert!(parameters.colors == Colors::Spread && parameters.becomes == Becomes::Light);
        assert!(parameters.selected.has("glazing") && !parameters.selected.has("wall"));
        parameters.read("f=data e=wall l- c=n d=");
        assert!(parameters.replaces_data && parameters.data_file == "data" && parameters.density == 20);
        assert!(parameters.selected.has("glazing") && !parameters.selected.has("wall"));
        parameters.read("m=other f= all");
        assert!(!parameters.replaces_data && parameters.data_file == "other" && parameters.selected == Selected::All);
    }

    #[test]
    fn unknown_words_are_returned() {
        let mut parameters = Parameters::default();
        let unknown = ["x=1", "d=bsdf.xml", "s=", "s=1.5", "c=x", "b=nan", "m=", "o=", "l", "q"];
        let result = parameters.read(&unknown.join(" "));
        assert_eq!(result.unknown, unknown);
        assert_eq!((parameters.density, parameters.samples), (48, 32));
    }

    #[test]
    fn what_was_made_before_is_left_alone() {
        let mut parameters = Parameters::default();
        let result = parameters.read("! d=3");
        assert!(result.is_processed && parameters.selected == Selected::Nothing && parameters.density == 48);
    }
}
