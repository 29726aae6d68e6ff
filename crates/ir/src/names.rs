//! Names of primitives, stored in one block: a scene may have millions.

/// A name in [`Names`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NameId(u32);

/// All names in order of insertion.
#[derive(Clone, Debug, Default)]
pub struct Names {
    text: String,
    ends: Vec<u64>,
}

impl Names {
    /// Adds a name.
    pub fn add(&mut self, name: &str) -> NameId {
        self.text.push_str(name);
        self.ends.push(self.text.len() as u64);
        NameId(u32::try_from(self.ends.len() - 1).expect("fewer than 2^32 names"))
    }

    /// The text of a name.
    #[must_use]
    pub fn get(&self, id: NameId) -> &str {
        let index = id.0 as usize;
        let start = if index == 0 { 0 } else { self.ends[index - 1] as usize };
        &self.text[start..self.ends[index] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_stored_verbatim() {
        let mut names = Names::default();
        let ids = ["a", "", "kitchen wall"].map(|name| names.add(name));
        assert_eq!(ids.map(|id| names.get(id).to_owned()), ["a", "", "kitchen wall"]);
    }
}
