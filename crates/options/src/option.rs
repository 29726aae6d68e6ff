//! One option: an entry of the table.

/// An option of a program.
#[derive(Clone, Copy, Debug)]
pub struct ProgramOption {
    /// As it is typed, with its dash; the first letters of it where [`OptionForm`] says so.
    pub name: &'static str,
    /// Other names of the same option.
    pub aliases: &'static [&'static str],
    /// How the word is written.
    pub form: OptionForm,
    /// What stands after the word, a name for each value; for attached text, what that text is.
    pub values: &'static str,
    /// The unit of the values; empty for none.
    pub unit: &'static str,
    /// The values that hold where the option is not given, as they are typed; `+` or `-` of a switch. Empty for none.
    pub default: &'static str,
    /// What it does, as a sentence without its full stop.
    pub help: &'static str,
    /// How `-defaults` prints it; `None` where it does not.
    pub listing: Option<Listing>,
}

/// How the word of an option is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OptionForm {
    /// The name, then the values as words of their own.
    Word,
    /// The name alone turns the state over; with `+` or `1` it is on, with `-` or `0` off.
    Switch,
    /// The name with text attached to it, or without.
    Attached,
    /// Any word that begins with the name, then the values: Radiance's program looks at no more letters.
    Beginning,
    /// The name, or the name with `+` in place of its dash, which takes the option back; then the values.
    Signed,
}

/// How `-defaults` prints an option: its form, and what stands behind `#`.
#[derive(Clone, Copy, Debug)]
pub enum Listing {
    /// A switch: what it means when it is off and on.
    Switch([&'static str; 2]),
    /// A switch that is printed only while it is on.
    SwitchOn(&'static str),
    /// Whole numbers, padded to this width, then tabs.
    Whole(usize, &'static str, &'static str),
    /// Numbers with six digits after the point, then tabs.
    Fixed(&'static str, &'static str),
    /// Numbers with one digit after the point, then tabs.
    OneDigit(&'static str, &'static str),
    /// Numbers with an exponent and two digits after the point, then tabs.
    Scientific(&'static str, &'static str),
    /// A line that the program writes: it depends on more than the words of the option.
    Computed,
}

impl ProgramOption {
    const fn new(name: &'static str, form: OptionForm, values: &'static str, help: &'static str) -> Self {
        ProgramOption { name, aliases: &[], form, values, unit: "", default: "", help, listing: None }
    }

    /// How many words follow as values.
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

    /// How the option is typed, for help and manual pages: `-bv[+|-]`, `-f[TEXT]`, `-vp X Y Z`.
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

/// An option of which the first letters count.
pub(crate) const fn beginning(name: &'static str, values: &'static str, help: &'static str) -> ProgramOption {
    ProgramOption::new(name, OptionForm::Beginning, values, help)
}

/// An option that `+` takes back.
pub(crate) const fn signed(name: &'static str, values: &'static str, help: &'static str) -> ProgramOption {
    ProgramOption::new(name, OptionForm::Signed, values, help)
}
