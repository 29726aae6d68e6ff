//! Generates random programs of the language, for tests.

/// A small random number generator, which makes failures reproducible.
pub(crate) struct Dice {
    state: u64,
    /// Whether programs use real arguments and the initial library.
    pub(crate) calls_library: bool,
}

impl Dice {
    pub(crate) fn new(seed: u64) -> Dice {
        Dice { state: seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1, calls_library: false }
    }

    fn roll(&mut self) -> u64 {
        self.state ^= self.state << 13;
        self.state ^= self.state >> 7;
        self.state ^= self.state << 17;
        self.state.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 20
    }

    pub(crate) fn below(&mut self, end: u64) -> u64 {
        self.roll() % end
    }

    /// A number with few bits, so that sums and most products of such numbers are exact.
    pub(crate) fn number(&mut self) -> f64 {
        match self.below(6) {
            0 => 0.0,
            1 => self.below(5) as f64,
            2 => -(self.below(3) as f64),
            _ => self.below(256) as f64 / 64.0 - 1.5,
        }
    }
}

/// Generates expressions.
struct Writer<'d> {
    dice: &'d mut Dice,
    parameters: u64,
    variables: u64,
    functions: u64,
}

const FUNCTIONS: [&str; 12] =
    ["sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "log10", "floor", "ceil", "sqrt"];

impl Writer<'_> {
    fn expression(&mut self, depth: u64) -> String {
        if depth == 0 {
            return self.leaf();
        }
        let mut next = || self.expression(depth - 1);
        let (a, b, c) = (next(), next(), next());
        match self.dice.below(28) {
            0..4 => format!("({a}+{b})"),
            4..6 => format!("({a}-{b})"),
            6..9 => format!("{a}*{b}"),
            9 => format!("{a}/({b})"),
            10 => format!("({a})^{}", self.dice.below(4) as f64 / 2.0),
            11 => format!("({a})^({b})"),
            12..15 => format!("if({a},{b},{c})"),
            15 => format!("if({a}-{b},if({b}-{c},1,-1),{c})"),
            16 => format!("select({a},{b},{c},{a})"),
            17 => format!("min({a},{b},{c})"),
            18 => format!("max({a},{b})"),
            19 if self.dice.calls_library => format!("if(and({a},or({b},not({c}))),{c},{b})"),
            20 => format!("-({a})"),
            24 => format!("atan2({a},{b})"),
            25 => format!("rand({a})"),
            21 if self.functions > 0 => format!("f{}({a},{b})", self.dice.below(self.functions)),
            22 if self.dice.calls_library => format!("bound(-1,{a},1)+abs({b})+noneg({c})"),
            23 if self.dice.calls_library => format!("Acos({a})"),
            _ => format!("{}({a})", FUNCTIONS[self.dice.below(FUNCTIONS.len() as u64) as usize]),
        }
    }

    fn leaf(&mut self) -> String {
        match self.dice.below(8) {
            0..2 => format!("${}", 1 + self.dice.below(4)),
            2..4 if self.variables > 0 => format!("v{}", self.dice.below(self.variables)),
            4 if self.parameters > 0 => ["x", "y"][self.dice.below(2) as usize].to_owned(),
            5 if self.dice.calls_library => format!("arg({})", self.dice.below(3)),
            6 => "select($1+2,1,2,5,9)".to_owned(),
            _ => match self.dice.number() {
                number if number < 0.0 => format!("({number})"),
                number => number.to_string(),
            },
        }
    }
}

/// Definitions, and two expressions of them and of four channels.
pub(crate) fn program_text(dice: &mut Dice) -> (String, [String; 2]) {
    let mut text = String::new();
    let mut writer = Writer { dice, parameters: 0, variables: 0, functions: 0 };
    for index in 0..writer.dice.below(4) {
        writer.parameters = 2;
        text += &format!("f{index}(x,y) = {};\n", writer.expression(2));
        writer.parameters = 0;
        writer.functions = index + 1;
        text += &format!("v{index} = {};\n", writer.expression(3));
        writer.variables = index + 1;
    }
    let roots = [writer.expression(3), writer.expression(2)];
    (text, roots)
}
