//! The lines of a GLSL shader that its preprocessor leaves, as far as the text itself says: engines put all their kinds
//! of materials into one text, and choose by what they define.

use std::collections::BTreeMap;

/// Limit on what an expression consists of, as its parentheses are followed by calls: anybody may have written it.
const MOST_TOKENS: usize = 400;

/// Returns the lines of code (without comments) that are compiled, or may be: what depends on macros that only a driver
/// knows is left in.
pub(super) fn compiled(code: &str) -> String {
    let joined = code.replace("\\\r\n", " ").replace("\\\n", " ");
    let mut state = Preprocessor::default();
    let mut left = String::with_capacity(joined.len());
    for line in joined.lines() {
        // The body of a macro counts as code: it is not followed to where the macro is used.
        let is_left = match line.trim_start().strip_prefix('#') {
            Some(directive) => state.follow(directive.trim_start()),
            None => true,
        };
        if is_left && state.is_compiled() != Some(false) {
            left.push_str(line);
            left.push('\n');
        }
    }
    left
}

/// A branch of a conditional.
#[derive(Debug, Clone, Copy)]
struct Branch {
    /// Whether it is compiled, where all around it is; `None` where that is not known.
    is_taken: Option<bool>,
    /// Whether it or one before it is.
    is_any_taken: Option<bool>,
}

/// What is known at a line.
#[derive(Debug, Default)]
struct Preprocessor<'a> {
    /// The macros that are defined, each with its body; `None` for those that may be, or with another body.
    macros: BTreeMap<&'a str, Option<&'a str>>,
    /// The conditionals that the line is in, the outermost first.
    branches: Vec<Branch>,
    /// How many of these branches are left out, and of how many that is not known.
    left_out: usize,
    unknown: usize,
    /// Whether text that is not here is included: it may define anything.
    includes: bool,
}

impl<'a> Preprocessor<'a> {
    /// Returns whether the line is compiled.
    fn is_compiled(&self) -> Option<bool> {
        (self.left_out > 0 || self.unknown == 0).then_some(self.left_out == 0)
    }

    /// Follows a directive; returns whether it has code of its own: the body of a macro.
    fn follow(&mut self, directive: &'a str) -> bool {
        let end = directive.find(|c: char| !c.is_alphanumeric()).unwrap_or(directive.len());
        let (keyword, rest) = (&directive[..end], directive[end..].trim());
        match keyword {
            "if" => self.begin(self.is_true(rest)),
            "ifdef" => self.begin(self.is_defined(rest)),
            "ifndef" => self.begin(self.is_defined(rest).map(|is_defined| !is_defined)),
            "elif" => self.go_on(self.is_true(rest)),
            "else" => self.go_on(Some(true)),
            "endif" => self.end(),
            "include" => self.includes |= self.is_compiled() != Some(false),
            "define" => {
                let (name, body) = first_name(rest);
                self.set(name, Some(body));
            }
            "undef" => self.set(first_name(rest).0, None),
            _ => {}
        }
        keyword == "define"
    }

    fn begin(&mut self, is_taken: Option<bool>) {
        self.push(Branch { is_taken, is_any_taken: is_taken });
    }

    fn push(&mut self, branch: Branch) {
        self.left_out += usize::from(branch.is_taken == Some(false));
        self.unknown += usize::from(branch.is_taken.is_none());
        self.branches.push(branch);
    }

    fn pop(&mut self) -> Option<Branch> {
        let branch = self.branches.pop()?;
        self.left_out -= usize::from(branch.is_taken == Some(false));
        self.unknown -= usize::from(branch.is_taken.is_none());
        Some(branch)
    }

    fn end(&mut self) {
        self.pop();
    }

    /// The next branch of the innermost conditional: taken where no other was.
    fn go_on(&mut self, condition: Option<bool>) {
        let Some(before) = self.pop() else { return };
        let is_taken = both(before.is_any_taken.map(|is_taken| !is_taken), condition);
        self.push(Branch { is_taken, is_any_taken: either(before.is_any_taken, is_taken) });
    }

    /// Defines a macro with a body, or takes it away.
    fn set(&mut self, name: &'a str, body: Option<&'a str>) {
        match (self.is_compiled(), body) {
            (Some(true), Some(body)) => drop(self.macros.insert(name, Some(body))),
            (Some(true), None) => drop(self.macros.remove(name)),
            (None, _) => drop(self.macros.insert(name, None)),
            (Some(false), _) => {}
        }
    }

    /// Returns whether a name is defined; what follows it on its line, though nothing should, makes it unknown.
    fn is_defined(&self, line: &str) -> Option<bool> {
        let (name, rest) = first_name(line);
        if !rest.is_empty() {
            return None;
        }
        match self.macros.get(name) {
            Some(body) => body.map(|_| true),
            // Extensions, versions and profiles: drivers define them.
            None if self.includes || name.starts_with("GL_") || name.contains("__") => None,
            None => Some(false),
        }
    }

    fn is_true(&self, expression: &str) -> Option<bool> {
        let tokens = tokens(expression);
        let mut rest = &tokens[..tokens.len().min(MOST_TOKENS)];
        let value = self.any_of(&mut rest)?;
        // Other operators are not followed.
        (rest.is_empty() && tokens.len() <= MOST_TOKENS).then_some(value != 0)
    }

    /// `a || b`
    fn any_of(&self, rest: &mut &[&str]) -> Option<i64> {
        let mut value = self.all_of(rest);
        while skipped(rest, "||") {
            value = either(value.map(|one| one != 0), self.all_of(rest).map(|one| one != 0)).map(i64::from);
        }
        value
    }

    /// `a && b`
    fn all_of(&self, rest: &mut &[&str]) -> Option<i64> {
        let mut value = self.compared(rest);
        while skipped(rest, "&&") {
            value = both(value.map(|one| one != 0), self.compared(rest).map(|one| one != 0)).map(i64::from);
        }
        value
    }

    /// `a == b`, `a < b` and the like
    fn compared(&self, rest: &mut &[&str]) -> Option<i64> {
        let value = self.single(rest);
        let compare: fn(&i64, &i64) -> bool = match rest.first() {
            Some(&"==") => i64::eq,
            Some(&"!=") => i64::ne,
            Some(&"<=") => i64::le,
            Some(&">=") => i64::ge,
            Some(&"<") => i64::lt,
            Some(&">") => i64::gt,
            _ => return value,
        };
        *rest = &rest[1..];
        let other = self.single(rest);
        Some(i64::from(compare(&value?, &other?)))
    }

    /// A number, a macro, `defined`, `!`, or an expression in parentheses
    fn single(&self, rest: &mut &[&str]) -> Option<i64> {
        let (first, others) = rest.split_first()?;
        *rest = others;
        match *first {
            "!" => self.single(rest).map(|value| i64::from(value == 0)),
            "(" => {
                let value = self.any_of(rest);
                skipped(rest, ")").then_some(value)?
            }
            "defined" => {
                let is_in_parentheses = skipped(rest, "(");
                let (name, others) = rest.split_first()?;
                *rest = others;
                let is_whole = !is_in_parentheses || skipped(rest, ")");
                self.is_defined(name).filter(|_| is_whole).map(i64::from)
            }
            name => number(self.macros.get(name).copied().flatten().unwrap_or(name)),
        }
    }
}

/// Returns the name that a line begins with, and what follows it.
fn first_name(line: &str) -> (&str, &str) {
    let end = line.find(|c: char| !is_part_of_name(c)).unwrap_or(line.len());
    (&line[..end], line[end..].trim())
}

/// Returns whether both hold, one of them unknown or not.
fn both(one: Option<bool>, other: Option<bool>) -> Option<bool> {
    if [one, other].contains(&Some(false)) { Some(false) } else { Some(one? && other?) }
}

/// Returns whether either holds, one of them unknown or not.
fn either(one: Option<bool>, other: Option<bool>) -> Option<bool> {
    both(one.map(|one| !one), other.map(|other| !other)).map(|neither| !neither)
}

/// Goes past a token, if it is the next.
fn skipped(rest: &mut &[&str], token: &str) -> bool {
    let is_next = rest.first() == Some(&token);
    *rest = &rest[usize::from(is_next)..];
    is_next
}

/// Returns a decimal number's value.
fn number(text: &str) -> Option<i64> {
    (text == "0" || !text.starts_with('0')).then(|| text.parse().ok())?
}

const fn is_part_of_name(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// Returns the names, numbers and operators of an expression.
fn tokens(mut text: &str) -> Vec<&str> {
    let mut found = Vec::new();
    loop {
        text = text.trim_start();
        let Some(first) = text.chars().next() else { return found };
        let of_two = ["||", "&&", "==", "!=", "<=", ">="].iter().any(|operator| text.starts_with(operator));
        let length = match text.find(|c| !is_part_of_name(c)).unwrap_or(text.len()) {
            0 if of_two => 2,
            0 => first.len_utf8(),
            of_name => of_name,
        };
        found.push(&text[..length]);
        text = &text[length..];
    }
}

#[cfg(test)]
mod tests {
    use super::compiled;

    /// The words that are left of a text, a word a line but for directives.
    fn left(text: &str) -> String {
        compiled(text).lines().filter(|line| !line.starts_with('#')).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn what_the_text_decides_is_decided() {
        assert_eq!(left("a\n#ifdef A\nb\n#else\nc\n#endif\nd"), "a c d");
        assert_eq!(left("#define A\n  #  ifdef A\nb\n#else\nc\n#endif"), "b");
        assert_eq!(left("#define A\n#undef A\n#ifndef A\nb\n#endif"), "b");
        assert_eq!(left("#define A\n#if defined(B)\nb\n#elif defined A && !defined(B)\nc\n#else\nd\n#endif"), "c");
        assert_eq!(left("#define A 3\n#if (A >= 2 || B) && A != 4\nb\n#endif"), "b");
        assert_eq!(left("#if 0\n#if 1\na\n#else\nb\n#endif\n#define A\n#elif 1\nc\n#endif\n#ifdef A\nd\n#endif"), "c");
        assert_eq!(left("#if defined(A) || \\\n  defined(B)\nb\n#endif\nc"), "c");
        assert_eq!(left("#endif\n#else\na"), "a");
    }

    #[test]
    fn what_the_driver_decides_is_left_in() {
        for condition in ["ifdef GL_ES", "if __VERSION__ > 130", "if A + 1", "if A", "if (1", "if", "if defined(GL_ES"]
        {
            assert_eq!(left(&format!("#{condition}\na\n#else\nb\n#endif")), "a b", "{condition}");
        }
        assert_eq!(left("#ifdef GL_ES\n#define A\n#endif\n#ifdef A\na\n#else\nb\n#endif"), "a b");
        assert_eq!(left("#if defined(GL_ES) && defined(A)\na\n#else\nb\n#endif"), "b");
        assert_eq!(left("#if defined(GL_ES) || 1\na\n#elif 1\nb\n#else\nc\n#endif"), "a");
        assert_eq!(left("#if 0\na\n#elif defined(GL_ES)\nb\n#else\nc\n#endif"), "b c");
        let deep = format!("#if {}1{}\na\n#endif", "(".repeat(100_000), ")".repeat(100_000));
        assert_eq!(left(&deep), "a");
        assert_eq!(left("#include </own>\n#ifdef A\na\n#endif"), "a");
    }

    #[test]
    fn bodies_of_macros_are_code() {
        assert_eq!(
            compiled("#define KILL discard\n#if 0\n#define ALSO gl_FragDepth\n#endif\n"),
            "#define KILL discard\n"
        );
    }
}
