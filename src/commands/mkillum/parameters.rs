//! What comments `#@mkillum` say.

/// Which surfaces become lights.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Selected {
    All,
    Nothing,
    /// Those of a modifier.
    Only(String),
    /// Those of all others.
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

/// What is kept of colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Colors {
    /// Lights are grey.
    Nothing,
    /// The mean colour of each light.
    Mean,
    /// The colour of each direction.
    Spread,
}

/// What surfaces become.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Becomes {
    Illum,
    Light,
}

/// What holds for the surfaces that follow.
#[derive(Clone, Debug)]
pub(super) struct Parameters {
    pub(super) material: String,
    pub(super) data_file: String,
    /// The number of the next data file; 0 is not written.
    pub(super) data_number: u32,
    /// Whether the data file is named, so that one that is there may be replaced.
    pub(super) replaces_data: bool,
    pub(super) selected: Selected,
    pub(super) colors: Colors,
    /// Directions for each projected steradian; 0 for lights that shine evenly.
    pub(super) density: u32,
    /// Rays for each direction.
    pub(super) samples: u32,
    /// Surfaces with less radiance stay as they are, W/(sr·m²).
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

/// What else a comment says.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Said {
    /// A file for all that follows.
    pub(super) output: Option<String>,
    /// What data files are to be called, if that changes.
    pub(super) names_data: Option<String>,
    /// Whether the text is output of this program already; then nothing more of the comment counts.
    pub(super) is_processed: bool,
    /// Words that mean nothing.
    pub(super) unknown: Vec<String>,
}

impl Parameters {
    /// Reads the words of a comment.
    pub(super) fn read(&mut self, text: &str) -> Said {
        let mut said = Said::default();
        let before = self.data_file.clone();
        for word in text.split_ascii_whitespace() {
            if word.starts_with('!') {
                self.selected = Selected::Nothing;
                said.is_processed = true;
                return said;
            }
            match word.strip_prefix("o=").filter(|file| !file.is_empty()) {
                Some(file) => said.output = Some(file.to_owned()),
                None if self.take(word).is_some() => {}
                None => said.unknown.push(word.to_owned()),
            }
        }
        said.names_data = Some(self.data_file.clone()).filter(|name| *name != before);
        said
    }

    /// Takes one word; `None` if it means nothing.
    fn take(&mut self, word: &str) -> Option<()> {
        match word {
            "l+" => self.becomes = Becomes::Light,
            "l-" => self.becomes = Becomes::Illum,
            // As in Radiance, where words may go on behind their first letter.
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

/// A whole number; below zero is zero.
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
        let said = parameters.read(" m=win c=d d=20 s=8\tl+ b=.5 i=glazing o=out.rad");
        assert_eq!((said.output.as_deref(), said.unknown.len()), (Some("out.rad"), 0));
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
    fn words_that_mean_nothing_are_told() {
        let mut parameters = Parameters::default();
        let unknown = ["x=1", "d=bsdf.xml", "s=", "s=1.5", "c=x", "b=nan", "m=", "o=", "l", "q"];
        let said = parameters.read(&unknown.join(" "));
        assert_eq!(said.unknown, unknown);
        assert_eq!((parameters.density, parameters.samples), (48, 32));
    }

    #[test]
    fn what_was_made_before_is_left_alone() {
        let mut parameters = Parameters::default();
        let said = parameters.read("! d=3");
        assert!(said.is_processed && parameters.selected == Selected::Nothing && parameters.density == 48);
    }
}
