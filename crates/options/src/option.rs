//! One option: an entry of the table.

/// An option of a program.
#[derive(Clone, Copy, Debug)]
pub struct ProgramOption {
    /// Its name with the dash; the first letters if [`OptionForm`] says so.
    pub name: &'static str,
    /// Other names of the option.
    pub aliases: &'static [&'static str],
    /// The form of its word.
    pub form: OptionForm,
    /// The values after the word, a name for each; for attached text, the name of that text.
    pub values: &'static str,
    /// The unit of the values; empty for none.
    pub unit: &'static str,
    /// The default values as typed; `+` or `-` for a switch. Empty for none.
    pub default: &'static str,
    /// The help text, a sentence without its full stop.
    pub help: &'static str,
    /// Its format in `-defaults`; `None` if it is not listed.
    pub listing: Option<Listing>,
}

/// The form of an option's word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OptionForm {
    /// The name, followed by the values as separate words.
    Word,
    /// The name alone toggles the state; a suffix `+` or `1` turns it on, `-` or `0` off.
    Switch,
    /// The name with optional text attached.
    Attached,
    /// Any word that begins with the name, then the values: Radiance's program compares only these
    /// letters.
    Beginning,
    /// The name, or the name with `+` instead of its dash, which undoes the option; then the
    /// values.
    Signed,
}

/// The format of an option in `-defaults`, and the text after `#`.
#[derive(Clone, Copy, Debug)]
pub enum Listing {
    /// A switch, with its meaning when off and on.
    Switch([&'static str; 2]),
    /// A switch that is listed only while it is on.
    SwitchOn(&'static str),
    /// Integers, padded to this width, then tabs.
    Whole(usize, &'static str, &'static str),
    /// Numbers with six decimals, then tabs.
    Fixed(&'static str, &'static str),
    /// Numbers with one decimal, then tabs.
    OneDigit(&'static str, &'static str),
    /// Numbers with an exponent and two decimals, then tabs.
    Scientific(&'static str, &'static str),
    /// A line computed by the program: it depends on more than the option's words.
    Computed,
}

impl ProgramOption {
    const fn new(name: &'static str, form: OptionForm, values: &'static str, help: &'static str) -> Self {
        ProgramOption { name, aliases: &[], form, values, unit: "", default: "", help, listing: None }
    }

    /// Number of values.
    #[must_use]
    pub fn value_count(&self) -> usize {
        match self.form {
            OptionForm::Switch | OptionForm::Attached => 0,
            OptionForm::Word | OptionForm::Beginning | OptionForm::Signed => self.values.split_whitespace().count(),
        }
    }

    /// The name and all aliases.
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        std::iter::once(self.name).chain(self.aliases.iter().copied())
    }

    /// The usage of the option, for help and manual pages: `-bv[+|-]`, `-f[TEXT]`, `-vp X Y Z`.
    #[must_use]
    pub fn usage(&self) -> String {
        let names: Vec<&str> = self.names().collect();
        let names = names.join(", ");
        match self.form {
            OptionForm::Switch => format!("{names}[+|-]"),
            OptionForm::Attached => format!("{names}{}", self.values),
            OptionForm::Signed => {
                let bare = &self.name[1..];
                format!("{names}, +{bare} {}", self.values).trim_end().to_owned()
            }
            OptionForm::Word | OptionForm::Beginning => format!("{names} {}", self.values).trim_end().to_owned(),
        }
    }

    pub(crate) const fn aliases(self, aliases: &'static [&'static str]) -> Self {
        ProgramOption { aliases, ..self }
    }

    pub(crate) const fn unit(self, unit: &'static str) -> Self {
        ProgramOption { unit, ..self }
    }

    pub(crate) const fn default(self, default: &'static str) -> Self {
        ProgramOption { default, ..self }
    }

    pub(crate) const fn listed(self, listing: Listing) -> Self {
        ProgramOption { listing: Some(listing), ..self }
    }
}

/// An option without values.
pub(crate) const fn flag(name: &'static str, help: &'static str) -> ProgramOption {
    ProgramOption::new(name, OptionForm::Word, "", help)
}

/// An option with values after it.
pub(crate) const fn value(name: &'static str, values: &'static str, help: &'static str) -> ProgramOption {
    ProgramOption::new(name, OptionForm::Word, values, help)
}

/// A switch.
pub(crate) const fn switch(name: &'static str, help: &'static str) -> ProgramOption {
    ProgramOption::new(name, OptionForm::Switch, "", help)
}

/// An option with text attached to its name.
pub(crate) const fn attached(name: &'static str, text: &'static str, help: &'static str) -> ProgramOption {
    ProgramOption::new(name, OptionForm::Attached, text, help)
}

/// An option identified by its first letters.
pub(crate) const fn beginning(name: &'static str, values: &'static str, help: &'static str) -> ProgramOption {
    ProgramOption::new(name, OptionForm::Beginning, values, help)
}

/// An option that `+` undoes.
pub(crate) const fn signed(name: &'static str, values: &'static str, help: &'static str) -> ProgramOption {
    ProgramOption::new(name, OptionForm::Signed, values, help)
}
