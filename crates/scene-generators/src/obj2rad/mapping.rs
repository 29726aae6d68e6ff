//! Mapping files: rules that select the material of a face.
//!
//! `plastic_red (Material "Red") (Face [1:20]) ;`: the name of a Radiance material and conditions,
//! all of which must hold. Later rules take precedence over earlier ones; faces without a rule, and
//! those of the material `void`, are omitted.

/// The properties of a face that a rule can test.
pub(super) struct Situation<'a> {
    pub(super) material: &'a str,
    pub(super) map: &'a str,
    pub(super) groups: &'a [String],
    pub(super) object: &'a str,
    pub(super) face: usize,
}

pub(super) struct Mapping {
    /// In file order.
    rules: Vec<Rule>,
}

struct Rule {
    material: String,
    conditions: Vec<Condition>,
}

enum Condition {
    Material(Wanted),
    Map(Wanted),
    Group(Wanted),
    Object(Wanted),
    Face(Wanted),
}

enum Wanted {
    Name(String),
    Numbers(i64, i64),
}

impl Wanted {
    fn is_name(&self, name: &str) -> bool {
        matches!(self, Wanted::Name(wanted) if wanted == name)
    }
}

impl Mapping {
    pub(super) fn read(text: &str) -> Result<Mapping, String> {
        let mut rules = Vec::new();
        let mut rest = text.trim_start();
        while !rest.is_empty() {
            if rest.starts_with('#') {
                rest = rest.split_once('\n').map_or("", |(_, behind)| behind).trim_start();
                continue;
            }
            let end = rest.find([' ', '\t', ';', '\n']).unwrap_or(rest.len());
            let material = rest[..end].to_owned();
            let (conditions, behind) =
                read_conditions(&rest[end..]).map_err(|mistake| format!("rule {}: {mistake}", rules.len() + 1))?;
            rules.push(Rule { material, conditions });
            rest = behind.trim_start();
        }
        Ok(Mapping { rules })
    }

    /// The material of a face, if it is converted.
    pub(super) fn material(&self, situation: &Situation<'_>) -> Option<String> {
        let rule =
            self.rules.iter().rev().find(|rule| rule.conditions.iter().all(|condition| condition.holds(situation)))?;
        (rule.material != "void").then(|| rule.material.clone())
    }
}

impl Condition {
    fn holds(&self, situation: &Situation<'_>) -> bool {
        match self {
            Condition::Material(wanted) => !situation.material.is_empty() && wanted.is_name(situation.material),
            Condition::Map(wanted) => !situation.map.is_empty() && wanted.is_name(situation.map),
            Condition::Group(wanted) => situation.groups.iter().any(|group| wanted.is_name(group)),
            Condition::Object(wanted) => !situation.object.is_empty() && wanted.is_name(situation.object),
            Condition::Face(Wanted::Numbers(low, high)) => (*low..=*high).contains(&(situation.face as i64)),
            Condition::Face(Wanted::Name(_)) => false,
        }
    }
}

/// Conditions up to a semicolon or the end, and the rest of the text.
fn read_conditions(text: &str) -> Result<(Vec<Condition>, &str), String> {
    let mut conditions = Vec::new();
    let mut rest = text;
    loop {
        let Some(next) = rest.find(['(', ';']) else { return Ok((conditions, "")) };
        if rest.as_bytes()[next] == b';' {
            return Ok((conditions, &rest[next + 1..]));
        }
        let inside = rest[next + 1..].trim_start();
        let end = inside.find(char::is_whitespace).ok_or("a condition has no value")?;
        let (variable, value) = (&inside[..end], inside[end..].trim_start());
        let (wanted, behind) = read_wanted(value)?;
        rest = behind;
        conditions.push(match variable {
            "Material" => Condition::Material(wanted),
            "Map" => Condition::Map(wanted),
            "Group" => Condition::Group(wanted),
            "Object" => Condition::Object(wanted),
            "Face" => Condition::Face(wanted),
            _ => return Err(format!("unknown variable \"{variable}\", expected Material, Map, Group, Object or Face")),
        });
    }
}

/// `"name")`, `[low:high])` or `number)`, and the rest of the text.
fn read_wanted(value: &str) -> Result<(Wanted, &str), String> {
    if let Some(name) = value.strip_prefix('"') {
        let (name, behind) = name.split_once('"').ok_or("a name is not closed")?;
        return Ok((Wanted::Name(name.to_owned()), behind.trim_start().strip_prefix(')').unwrap_or(behind)));
    }
    let (numbers, behind) = value.split_once(')').ok_or("a condition is not closed")?;
    let number = |text: &str| text.trim().parse::<i64>().map_err(|_| format!("\"{}\" is not a number", text.trim()));
    let range = numbers.trim().strip_prefix('[').and_then(|numbers| numbers.strip_suffix(']'));
    let (low, high) = match range {
        Some(range) => {
            let (low, high) = range.split_once(':').ok_or_else(|| format!("\"{range}\" is not a range"))?;
            (number(low)?, number(high)?)
        }
        None => (number(numbers)?, number(numbers)?),
    };
    if low > high {
        return Err(format!("the range {low}:{high} is reversed"));
    }
    Ok((Wanted::Numbers(low, high), behind))
}
