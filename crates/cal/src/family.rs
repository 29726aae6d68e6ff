//! Programs that differ in their real arguments alone, such as the normals of a smoothed mesh: one
//! function file, thousands of modifiers.

use crate::bindings::{Bindings, Known};
use crate::definitions::Definitions;
use crate::names::Scope;
use crate::program::{Compiled, Program, Root, read_roots};
use radsight_diag::Diagnostic;
use std::sync::Arc;

/// Number of programs that are compiled each for its own arguments, before code is shared. Such
/// code is faster where arguments decide what is computed.
const MOST_OF_THEIR_OWN: usize = 4;

/// Maximum number of shared codes, one for each combination of arguments that decide.
const MOST_SHARED: usize = 8;

/// Programs of the same roots, in the same scope, with other real arguments.
///
/// After the first few, all programs share the code, if only some of the arguments decide what it
/// is; each then costs no more than its numbers. Values are the same, bit for bit.
#[derive(Debug, Default)]
pub struct Family {
    compiled: usize,
    shared: Vec<Shared>,
    has_given_up: bool,
}

/// Code for all values of some real arguments.
#[derive(Debug)]
struct Shared {
    /// The value of each argument that is the same for all, `None` for one that may differ.
    same: Box<[Option<u64>]>,
    compiled: Arc<Compiled>,
}

impl Shared {
    fn serves(&self, real_arguments: &[f64]) -> bool {
        self.same.len() == real_arguments.len()
            && self.same.iter().zip(real_arguments).all(|(same, argument)| match same {
                Some(bits) => argument.to_bits() == *bits,
                None => argument.is_finite(),
            })
    }
}

impl Family {
    /// A program, as by [`Program::compile`]. `definitions`, `scope`, the names and texts of `roots`,
    /// and `bindings` apart from its real arguments must be the same at each call.
    ///
    /// # Errors
    /// Those of [`Program::compile`].
    pub fn program(
        &mut self,
        definitions: &Definitions,
        scope: &Scope,
        roots: &[Root<'_>],
        bindings: &Bindings<'_>,
    ) -> Result<Program, Vec<Diagnostic>> {
        let real_arguments = bindings.real_arguments;
        if let Some(shared) = self.shared.iter().find(|shared| shared.serves(real_arguments)) {
            return Ok(Program::new(Arc::clone(&shared.compiled), real_arguments));
        }
        self.compiled += 1;
        if self.compiled > MOST_OF_THEIR_OWN && !self.has_given_up && real_arguments.iter().all(|x| x.is_finite()) {
            let shared = share(definitions, scope, roots, bindings);
            self.has_given_up = shared.is_none() || self.shared.len() + 1 == MOST_SHARED;
            if let Some(shared) = shared {
                let program = Program::new(Arc::clone(&shared.compiled), real_arguments);
                self.shared.push(shared);
                return Ok(program);
            }
        }
        Program::compile(definitions, scope, roots, bindings)
    }
}

/// Code for these real arguments and as many others as possible; `None` if it would be for these
/// alone, or if there are mistakes.
fn share(definitions: &Definitions, scope: &Scope, roots: &[Root<'_>], bindings: &Bindings<'_>) -> Option<Shared> {
    let mut known = Known::new(definitions);
    let roots = read_roots(&mut known, scope, roots).ok()?;
    let mut late = vec![true; bindings.real_arguments.len()];
    while late.contains(&true) {
        match Compiled::of_family(&known, &roots, bindings, &late)? {
            Ok(compiled) => {
                let same = late.iter().zip(bindings.real_arguments);
                let same = same.map(|(&late, argument)| (!late).then_some(argument.to_bits())).collect();
                return Some(Shared { same, compiled: Arc::new(compiled) });
            }
            Err(decisive) => decisive.into_iter().for_each(|argument| late[usize::from(argument)] = false),
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scratch;
    use radsight_diag::SourceMap;

    /// Four numbers and their result with the channels 5 and 7.
    type Case = ([f64; 4], f64);

    #[test]
    fn code_is_shared_where_the_same_arguments_decide() {
        let text = b"u = select(A1+1, $1, $2); f = if(A4, A2*u + A3, A2);";
        let mut sources = SourceMap::default();
        let file = sources.add("f.cal", text.as_slice(), None);
        let mut definitions = Definitions::with_initial_library();
        definitions.load(file, text, &Scope::global()).expect("the text is right");
        let root = Root::Expression { text: "f", span: sources.span(file, 0, 0) };
        let mut family = Family::default();
        let mut compile = |real_arguments: &[f64]| {
            let bindings = Bindings { real_arguments, ..Bindings::of_ray() };
            family.program(&definitions, &Scope::global(), &[root], &bindings).expect("it compiles")
        };
        let own: Vec<Program> = (0..4).map(|_| compile(&[0.0, 2.0, 3.0, 1.0])).collect();
        assert!(own.iter().all(|program| Arc::strong_count(program.compiled_code()) == 1));
        let cases: [Case; 6] = [
            ([0.0, 2.0, 3.0, 1.0], 13.0),
            ([0.0, -1.0, 0.5, 1.0], -4.5),
            ([1.0, 2.0, 3.0, 1.0], 17.0),
            ([1.0, 1.0, 0.0, 1.0], 7.0),
            // Arguments that no ray adds anything to are constants.
            ([1.0, 1.5, 3.0, -1.0], 1.5),
            ([1.0, 2.5, 3.0, -1.0], 2.5),
        ];
        let programs = cases.map(|(real_arguments, _)| compile(&real_arguments));
        let mut scratch = Scratch::new();
        for (program, (real_arguments, value)) in programs.iter().zip(&cases) {
            assert_eq!(program.eval(0, &[], &[5.0, 7.0][..], &mut scratch), Ok(*value), "{real_arguments:?}");
            assert_eq!(program.is_constant(), real_arguments[3] < 0.0);
        }
        let codes: Vec<_> = programs.iter().map(|program| program.compiled_code()).collect();
        assert!(Arc::ptr_eq(codes[0], codes[1]) && Arc::ptr_eq(codes[2], codes[3]) && !Arc::ptr_eq(codes[0], codes[2]));
    }
}
