use super::*;

/// Each item or mistake in one line.
fn outline(text: &str) -> Vec<String> {
    let mut items = Items::new(text.as_bytes()).unwrap();
    let mut lines = Vec::new();
    while let Some(item) = items.advance() {
        let at = |place: Place| &text[place.start as usize..place.end as usize];
        lines.push(match item {
            Ok(Item::Comment(place) | Item::Command(place)) => at(place).to_owned(),
            Ok(Item::Alias(alias)) => {
                let [modifier, name, target] = [alias.modifier, alias.name, alias.target].map(|word| at(word.place()));
                format!("{modifier} alias {name}={target}")
            }
            Ok(Item::Primitive(primitive)) => {
                let strings: Vec<&str> = primitive.strings.iter().map(|word| at(word.place())).collect();
                let (modifier, name) = (at(primitive.modifier.place()), at(primitive.name.place()));
                format!(
                    "{modifier} {} {name} {strings:?} {:?} {:?}",
                    primitive.kind, primitive.integers, primitive.reals
                )
            }
            Err(error) => {
                let hint = error.hint.map(|hint| format!(" ({hint})")).unwrap_or_default();
                format!("{:?}: {}{hint}", at(error.place), error.mistake)
            }
        });
    }
    lines
}

#[test]
fn all_forms_of_items_are_read() {
    let text = "#a\n!b \\\n c\nvoid alias x y inherit alias\rz x\r\r\nvoid texfunc 'n m' 2 \"a b\" & 1 -7 2 .5 1e3\n0 cone cone 0 0 0 void sphere s 0 0 1 1.";
    assert_eq!(
        outline(text),
        [
            "#a",
            "!b \\\n c",
            "void alias x=y",
            "inherit alias z=x",
            "void texfunc 'n m' [\"\\\"a b\\\"\", \"&\"] [-7] [0.5, 1000.0]",
            "0 cone cone [] [] []",
            "void sphere s [] [] [1.0]",
        ]
    );
}

#[test]
fn a_misspelt_type_has_a_hint_and_reading_goes_on() {
    let text = "void plastik red 0 0 5 1 0 0 0 0\nred sphere s 0 0 4 0 0 0 1\n";
    let expected = [
        "\"plastik\": unknown type \"plastik\" (did you mean \"plastic\"?)",
        "red sphere s [] [] [0.0, 0.0, 0.0, 1.0]",
    ];
    assert_eq!(outline(text), expected);
}

#[test]
fn too_few_arguments_point_at_the_word_that_begins_the_next_primitive() {
    let text = "void plastic red 0 0 5 1 0 0 0\nred sphere s 0 0 4 0 0 0 1";
    let expected = [
        "\"red\": expected real argument 5 of 5 of plastic \"red\", found \"red\" (\"red\" seems to begin the next primitive; is the count 5 too large?)",
        "red sphere s [] [] [0.0, 0.0, 0.0, 1.0]",
    ];
    assert_eq!(outline(text), expected);
}

#[test]
fn too_many_arguments_point_at_the_first_extra_one() {
    let text = "void plastic red 0 0 5 1 0 0 0 0 9 9\nred sphere s 0 0 4 0 0 0 1";
    let expected = [
        "void plastic red [] [] [1.0, 0.0, 0.0, 0.0, 0.0]",
        "\"9\": expected a primitive, found \"9\" (plastic \"red\" declares 5 real arguments; is the count too small?)",
        "red sphere s [] [] [0.0, 0.0, 0.0, 1.0]",
    ];
    assert_eq!(outline(text), expected);
}

#[test]
fn a_missing_count_is_explained() {
    let text = "void light l 0 3 1 1 1\nl sphere s 0 0 4 0 0 0 1";
    let found = outline(text);
    assert_eq!(found.last().unwrap(), "l sphere s [] [] [0.0, 0.0, 0.0, 1.0]");
    assert!(found[0].contains("expected the number of real arguments of light \"l\", found \"l\""), "{}", found[0]);
}

#[test]
fn a_comment_inside_a_primitive_is_explained() {
    let found = outline("void plastic red # nice\n0 0 5 1 0 0 0 0\nred sphere s 0 0 4 0 0 0 1");
    assert!(found[0].ends_with("(a comment cannot stand inside a primitive)"), "{}", found[0]);
    assert_eq!(found.last().unwrap(), "red sphere s [] [] [0.0, 0.0, 0.0, 1.0]");
}

#[test]
fn an_impossible_count_is_refused_before_memory_is_taken() {
    let found = outline("void polygon p 0 0 1000000000 1 2 3\n");
    assert_eq!(found, ["\"1000000000\": polygon \"p\" declares 1000000000 real arguments, but only 7 bytes follow"]);
}

#[test]
fn a_text_that_ends_early_says_what_was_expected() {
    assert_eq!(
        outline("void sphere s 0 0 4 1 2 3 "),
        ["\"3\": the text ends where real argument 4 of 4 of sphere \"s\" was expected"]
    );
    assert_eq!(outline("void"), ["\"void\": expected a primitive, found \"void\""]);
    assert_eq!(outline("void sphere \"s 0 0 4"), ["\"\\\"\": the quote is never closed"]);
}

#[test]
fn a_document_gives_the_same_items() {
    let text = "#a\n!b\nvoid alias x y\nvoid texfunc n 1 a 0 2 1 2\nvoid oops\nx sphere s 0 0 4 1 2 3 4\n";
    let document = Document::parse(std::sync::Arc::from(text.as_bytes()));
    let kept: Vec<String> = document.items().map(|item| format!("{item:?}")).collect();
    let mut items = Items::new(text.as_bytes()).unwrap();
    let mut walked = Vec::new();
    while let Some(item) = items.advance() {
        walked.push(format!("{item:?}"));
    }
    assert_eq!(kept, walked);
    assert_eq!(walked.len(), 6);
}

#[test]
fn the_range_of_a_real_argument_is_found() {
    let text = b"void sphere s 0 0 4  1 \"2\"\n 3 4";
    let mut items = Items::new(text).unwrap();
    let Some(Ok(Item::Primitive(sphere))) = items.advance() else { panic!() };
    let places: Vec<&[u8]> = (0..4)
        .map(|index| sphere.real_place(index))
        .map(|place| &text[place.start as usize..place.end as usize])
        .collect();
    assert_eq!(places, [&b"1"[..], b"\"2\"", b"3", b"4"]);
}

mod hostile {
    use super::*;
    use proptest::prelude::*;

    fn walk(text: &[u8]) -> usize {
        let mut items = Items::new(text).unwrap();
        let mut count = 0;
        while let Some(item) = items.advance() {
            if let Ok(Item::Primitive(primitive)) = item {
                assert!(primitive.real_place(primitive.reals.len()).end as usize <= text.len());
            }
            count += 1;
            assert!(count <= text.len(), "the walk does not come to an end");
        }
        count
    }

    proptest! {
        #[test]
        fn any_bytes_come_to_an_end(text in proptest::collection::vec(any::<u8>(), 0..400)) {
            walk(&text);
        }

        #[test]
        fn any_words_come_to_an_end(text in "([a-c\"'#!\\\\0-9.]{1,3}|void|sphere|alias|plastic|0|1|9999999|[ \n\r]){0,80}") {
            walk(text.as_bytes());
        }
    }
}
