//! Shell completions.

use crate::option::{OptionForm, ProgramOption};
use crate::program::Program;

/// A shell that completes command lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shell {
    /// GNU Bash with bash-completion.
    Bash,
    /// Z shell.
    Zsh,
    /// Fish.
    Fish,
}

impl Shell {
    /// All supported shells.
    pub const ALL: [Shell; 3] = [Shell::Bash, Shell::Zsh, Shell::Fish];

    /// The path of a program's completions below a shared folder such as `/usr/share`.
    #[must_use]
    pub fn file(self, name: &str) -> String {
        match self {
            Shell::Bash => format!("bash-completion/completions/{name}"),
            Shell::Zsh => format!("zsh/site-functions/_{name}"),
            Shell::Fish => format!("fish/vendor_completions.d/{name}.fish"),
        }
    }

    /// The completions of a program.
    #[must_use]
    pub fn completion(self, program: &Program) -> String {
        match self {
            Shell::Bash => bash(program),
            Shell::Zsh => zsh(program),
            Shell::Fish => fish(program),
        }
    }
}

/// The words of an option, each with its help text.
fn words(option: &'static ProgramOption) -> Vec<String> {
    let names = option.names();
    match option.form {
        OptionForm::Switch => names.flat_map(|name| [format!("{name}+"), format!("{name}-")]).collect(),
        OptionForm::Signed => names.flat_map(|name| [name.to_owned(), format!("+{}", &name[1..])]).collect(),
        OptionForm::Word | OptionForm::Attached | OptionForm::Beginning => names.map(str::to_owned).collect(),
    }
}

fn identifier(name: &str) -> String {
    name.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '_' }).collect()
}

fn bash(program: &Program) -> String {
    let name = program.name;
    let function = format!("_radsight_{}", identifier(name));
    let all: Vec<String> = program.options().flat_map(words).collect();
    format!(
        "# Completions of {name}, from the table of options of radsight.\n\
         {function}() {{\n    \
             local word=\"${{COMP_WORDS[COMP_CWORD]}}\"\n    \
             if [[ $word == [-+]* ]]; then\n        \
                 COMPREPLY=($(compgen -W '{}' -- \"$word\"))\n    \
             else\n        \
                 COMPREPLY=($(compgen -f -- \"$word\"))\n    \
             fi\n\
         }}\n\
         complete -o filenames -F {function} {name}\n",
        all.join(" ")
    )
}

fn zsh(program: &Program) -> String {
    let mut text =
        format!("#compdef {}\n# From the table of options of radsight.\nlocal -a options\noptions=(\n", program.name);
    for option in program.options() {
        let help = option.help.replace('\'', "'\\''").replace(':', "\\:");
        words(option).into_iter().for_each(|word| text.push_str(&format!("  '{word}:{help}'\n")));
    }
    text.push_str(")\nif [[ $PREFIX == [-+]* ]]; then\n  _describe -o option options\nelse\n  _files\nfi\n");
    text
}

fn fish(program: &Program) -> String {
    let mut text = format!("# Completions of {}, from the table of options of radsight.\n", program.name);
    for option in program.options() {
        let help = option.help.replace('\\', "\\\\").replace('\'', "\\'");
        for word in words(option) {
            let kind = match word.strip_prefix("--") {
                Some(long) => format!("-l '{long}'"),
                None if word.starts_with('-') => format!("-o '{}'", &word[1..]),
                None => format!("-a '{word}'"),
            };
            let takes = if option.value_count() > 0 { " -r" } else { "" };
            text.push_str(&format!("complete -c {} {kind}{takes} -d '{help}'\n", program.name));
        }
    }
    text
}
