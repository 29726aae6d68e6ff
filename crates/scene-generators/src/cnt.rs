//! `cnt [-s] N0 [N1 …]`: counts. Each line has one number per argument; the last one varies
//! fastest. `-s` shuffles the lines.
//!
//! The real program seeds the shuffle from the clock. Here the order in a scene is always the same,
//! so that the scene is reproducible; see [`radsight_loader::Loader::shuffle_seed`].

use std::fmt::Write;

use crate::arguments::Arguments;
use crate::text::Text;
use crate::{Error, Invocation, Output};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(invocation.argv);
    let is_shuffled = match arguments.option_before_numbers().map(|option| option.name) {
        None => false,
        Some("-s") => true,
        Some(_) => return Err(arguments.unknown()),
    };
    let mut limits = Vec::new();
    loop {
        let (position, word) = (arguments.position(), arguments.peek().unwrap_or_default());
        let limit = arguments.count("count")?;
        if limit < 2 {
            return Err(arguments.mistake(position, format!("count is {word}, expected a whole number of at least 2")));
        }
        limits.push(limit);
        if arguments.peek().is_none() {
            break;
        }
    }
    let lines = limits.iter().map(|limit| *limit as f64).product::<f64>();
    let mut text = invocation.text();
    text.expect_room(lines, 2.0 * limits.len() as f64 + 1.0)?;
    if is_shuffled {
        for line in shuffled(lines as u32, invocation.loader.shuffle_seed()) {
            write_line(&mut text, &limits, line)?;
        }
        return Ok(Output { standard_output: text.finish()?, warnings: arguments.warnings, ..Output::default() });
    }
    let mut counters = vec![0; limits.len()];
    loop {
        for counter in &counters {
            write!(text, "\t{counter}")?;
        }
        text.write_str("\n")?;
        let Some(place) = (0..limits.len()).rev().find(|place| counters[*place] + 1 < limits[*place]) else { break };
        counters[place] += 1;
        counters[place + 1..].fill(0);
    }
    Ok(Output { standard_output: text.finish()?, warnings: arguments.warnings, ..Output::default() })
}

/// The numbers below a count in random order (Fisher and Yates; Knuth, "The Art of Computer
/// Programming" 2, 3.4.2 P).
fn shuffled(count: u32, seed: u64) -> Vec<u32> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut numbers: Vec<u32> = (0..count).collect();
    for last in (1..numbers.len()).rev() {
        // The upper half of the product is a number up to `last`, uniform up to a relative error of
        // 2⁻⁶⁴.
        let chosen = (u128::from(random.next_u64()) * (last as u128 + 1)) >> 64;
        numbers.swap(last, chosen as usize);
    }
    numbers
}

/// Writes the line of a given index in unshuffled order.
fn write_line(text: &mut Text, limits: &[usize], line: u32) -> Result<(), Error> {
    let (mut counters, mut rest) = (vec![0; limits.len()], line as usize);
    for (counter, limit) in counters.iter_mut().zip(limits).rev() {
        (*counter, rest) = (rest % limit, rest / limit);
    }
    for counter in counters {
        write!(text, "\t{counter}")?;
    }
    Ok(text.write_str("\n")?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shuffled_numbers_are_all_there_in_another_order_for_each_seed() {
        let mut numbers = shuffled(1000, 1);
        assert_ne!(numbers, shuffled(1000, 2));
        assert_eq!(numbers, shuffled(1000, 1));
        assert!(numbers.iter().zip(0..).filter(|(number, place)| **number == *place).count() < 20);
        numbers.sort_unstable();
        assert!(numbers.into_iter().eq(0..1000));
    }
}
