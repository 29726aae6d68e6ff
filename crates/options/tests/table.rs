//! Invariants of every entry of the table.

use radsight_options::{OptionForm, Shell, help, manual_page, programs};
use std::collections::HashSet;

#[test]
fn programs_are_sorted_and_explained() {
    for pair in programs().windows(2) {
        let [first, second] = [pair[0].name, pair[1].name];
        assert!(first.to_lowercase() <= second.to_lowercase(), "{first} is listed before {second}, expected after it");
    }
    for program in programs() {
        assert!(program.synopsis.starts_with(program.name), "{}", program.name);
        assert!(!program.summary.is_empty() && !program.summary.ends_with('.'), "{}", program.name);
        assert_eq!(program.options().filter(|option| option.name == "--help").count(), 1, "{}", program.name);
    }
}

#[test]
fn names_are_unambiguous() {
    for program in programs() {
        let mut known = HashSet::new();
        for option in program.options() {
            for name in option.names() {
                // A name may occur once with separate values and once with attached text.
                let is_new = known.insert((name, option.form == OptionForm::Attached));
                assert!(is_new, "{} has {name} twice", program.name);
                let found = program.parse_word(name).map(|found| found.option.name);
                assert_eq!(found, Some(option.name), "{} {name}", program.name);
            }
        }
    }
}

#[test]
fn every_option_says_what_it_does() {
    for program in programs() {
        for option in program.options() {
            let of = format!("{} {}", program.name, option.name);
            assert!(option.help.len() > 4 && !option.help.ends_with('.'), "{of}");
            assert!(option.help.starts_with(|first: char| first.is_uppercase() || first.is_ascii_digit()), "{of}");
            let default = program.default_of(option);
            if option.value_count() > 1 && !default.is_empty() {
                assert_eq!(default.split_whitespace().count(), option.value_count(), "{of}");
            }
            if option.form == OptionForm::Switch && !default.is_empty() {
                assert!(matches!(default, "+" | "-"), "{of}");
            }
        }
        for (name, _) in program.defaults {
            assert!(program.options().any(|option| option.name == *name), "{} has no {name}", program.name);
        }
    }
}

#[test]
fn states_of_switches_are_attached() {
    let rtrace = radsight_options::program("rtrace").expect("a program");
    for (word, state) in
        [("-w", None), ("-w+", Some(true)), ("-w1", Some(true)), ("-w-", Some(false)), ("-w0", Some(false))]
    {
        let found = rtrace.parse_word(word).expect("a switch");
        assert_eq!((found.option.name, found.state, found.words()), ("-w", state, 1), "{word}");
    }
    assert!(rtrace.parse_word("-wx").is_none() && rtrace.parse_word("-").is_none());
    for (word, name, words) in
        [("-f", "-f", 2), ("-faf", "-f", 1), ("-ld+", "-ld", 1), ("-lr", "-lr", 2), ("-ov", "-o", 1)]
    {
        let found = rtrace.parse_word(word).expect("an option");
        assert_eq!((found.option.name, found.words()), (name, words), "{word}");
    }
}

#[test]
fn texts_name_every_option() {
    for program in programs() {
        let (help, page) = (help(program), manual_page(program));
        let completions = Shell::ALL.map(|shell| shell.completion(program));
        for option in program.options() {
            let name = option.name;
            assert!(help.contains(name), "{} {name}", program.name);
            assert!(page.replace("\\-", "-").contains(name), "{} {name}", program.name);
            for completion in &completions[..2] {
                assert!(completion.contains(name), "{} {name}: {completion}", program.name);
            }
            assert!(completions[2].contains(name.trim_start_matches('-')), "{} {name}", program.name);
        }
    }
}
