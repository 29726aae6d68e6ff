//! The chain of mirrors and dielectrics between a path's origin and its current point.

/// Maximum length of a chain that is traced backwards.
const MAX_INTERACTIONS: u8 = 16;

/// Perfectly specular interactions, in path order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub(crate) struct SpecularChain {
    /// One bit each, 1 for a reflection; the last is the least significant.
    reflected: u16,
    length: u8,
    is_lost: bool,
    /// Whether an interaction has changed the direction.
    is_bent: bool,
}

/// A perfectly specular interaction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SpecularEvent {
    Reflected,
    Transmitted,
}

impl SpecularEvent {
    /// A chain of interactions, as in [`SpecularEnd::chain`](crate::SpecularEnd::chain), with this one after it.
    pub(crate) fn appended_to(self, chain: u32) -> u32 {
        chain << 1 | u32::from(self == SpecularEvent::Reflected)
    }

    /// The other interaction of a surface.
    pub(crate) fn other(self) -> SpecularEvent {
        match self {
            SpecularEvent::Reflected => SpecularEvent::Transmitted,
            SpecularEvent::Transmitted => SpecularEvent::Reflected,
        }
    }
}

impl SpecularChain {
    /// The chain extended by one interaction.
    pub(crate) fn after(self, event: SpecularEvent) -> SpecularChain {
        SpecularChain {
            reflected: self.reflected << 1 | u16::from(event == SpecularEvent::Reflected),
            length: self.length.saturating_add(1),
            is_lost: self.is_lost || self.length >= MAX_INTERACTIONS,
            is_bent: true,
        }
    }

    /// The chain extended by a transmission that does not change the direction.
    pub(crate) fn after_straight_transmission(self) -> SpecularChain {
        SpecularChain { is_bent: self.is_bent, ..self.after(SpecularEvent::Transmitted) }
    }

    /// Whether it is straight: light sampling reaches what it shows.
    pub(crate) fn is_straight(self) -> bool {
        !self.is_bent && !self.is_lost
    }

    /// The chain of these interactions.
    pub(crate) fn of(events: &[SpecularEvent]) -> SpecularChain {
        events.iter().fold(SpecularChain::default(), |chain, event| chain.after(*event))
    }

    /// Whether its first interactions are those of `start`.
    pub(crate) fn begins_with(self, start: SpecularChain) -> bool {
        !self.is_lost
            && !start.is_lost
            && start.length <= self.length
            && u32::from(self.reflected) >> (self.length - start.length) == u32::from(start.reflected)
    }

    /// The chain after an interaction that cannot be reversed.
    pub(crate) fn lost(self) -> SpecularChain {
        SpecularChain { is_lost: true, ..self }
    }

    /// Its interactions from the first to the last; `None` if there are none, or one cannot be
    /// reversed.
    pub(crate) fn forwards(self) -> Option<impl Iterator<Item = SpecularEvent> + Clone> {
        self.is_known().then(|| (0..self.length).rev().map(move |bit| self.event(bit)))
    }

    /// Its interactions from the last to the first; `None` if there are none, or one cannot be
    /// reversed.
    pub(crate) fn backwards(self) -> Option<impl Iterator<Item = SpecularEvent> + Clone> {
        self.is_known().then(|| (0..self.length).map(move |bit| self.event(bit)))
    }

    fn is_known(self) -> bool {
        self.length > 0 && !self.is_lost
    }

    /// Counted from the last.
    fn event(self, bit: u8) -> SpecularEvent {
        if self.reflected >> bit & 1 == 1 { SpecularEvent::Reflected } else { SpecularEvent::Transmitted }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use SpecularEvent::{Reflected, Transmitted};

    #[test]
    fn a_chain_is_taken_from_its_end() {
        let chain = SpecularChain::default().after(Reflected).after(Transmitted).after(Transmitted);
        assert!(chain.backwards().is_some_and(|events| events.eq([Transmitted, Transmitted, Reflected])));
        assert!(chain.forwards().is_some_and(|events| events.eq([Reflected, Transmitted, Transmitted])));
        assert!(SpecularChain::default().backwards().is_none());
    }

    #[test]
    fn a_chain_begins_with_its_first_interactions() {
        let chain = SpecularChain::of(&[Reflected, Transmitted, Reflected]);
        for start in [&[][..], &[Reflected], &[Reflected, Transmitted], &[Reflected, Transmitted, Reflected]] {
            assert!(chain.begins_with(SpecularChain::of(start)), "{start:?}");
        }
        for other in [&[Transmitted][..], &[Reflected, Reflected], &[Reflected, Transmitted, Reflected, Reflected]] {
            assert!(!chain.begins_with(SpecularChain::of(other)), "{other:?}");
        }
    }

    #[test]
    fn panes_leave_a_chain_straight() {
        let through_panes = SpecularChain::default().after_straight_transmission().after_straight_transmission();
        assert!(through_panes.is_straight() && through_panes.backwards().is_some_and(|events| events.count() == 2));
        assert!(!through_panes.after(Reflected).after_straight_transmission().is_straight());
        assert!(!through_panes.lost().is_straight());
    }

    #[test]
    fn a_chain_that_is_too_long_is_not_taken() {
        let chain = |length: u32| (0..length).fold(SpecularChain::default(), |chain, _| chain.after(Reflected));
        assert!(chain(16).backwards().is_some_and(|events| events.eq([Reflected; 16])));
        assert!(chain(17).backwards().is_none() && chain(300).backwards().is_none());
        assert!(chain(3).lost().after(Reflected).backwards().is_none());
    }
}
