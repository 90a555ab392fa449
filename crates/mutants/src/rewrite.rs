//! Rewrites a source file so that one build has all of its mutants. A number in the environment selects one when the
//! program runs (mutant schemata: Untch, Offutt, Harrold 1993).

use crate::list::{Genre, Mutant};
use std::collections::HashMap;
use std::fmt::Write;
use std::ops::Range;
use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{Arm, BinOp, Expr, ExprBinary, ExprUnary};

/// A rewritten source file.
#[derive(Debug, Default)]
pub struct Rewritten {
    /// New text.
    pub text: String,
    /// Bytes of the new text that only one mutant uses, with its number.
    pub arms: Vec<(Range<usize>, u32)>,
    /// Bytes of each rewritten expression, with its mutants.
    pub wrappers: Vec<(Range<usize>, Vec<u32>)>,
}

impl Rewritten {
    /// Mutants that an error of the compiler at these bytes comes from.
    pub fn mutants_at(&self, at: &Range<usize>) -> Vec<u32> {
        let meets = |range: &Range<usize>| range.start < at.end && at.start < range.end;
        let contains = |range: &Range<usize>| range.start <= at.start && at.end <= range.end;
        let arms: Vec<u32> = self.arms.iter().filter(|(range, _)| contains(range)).map(|&(_, id)| id).collect();
        if !arms.is_empty() {
            return arms;
        }
        let around = self.wrappers.iter().filter(|(range, _)| contains(range));
        if let Some((_, ids)) = around.min_by_key(|(range, _)| range.len()) {
            return ids.clone();
        }
        self.wrappers.iter().filter(|(range, _)| meets(range)).flat_map(|(_, ids)| ids).copied().collect()
    }
}

/// Rewrites a file. Mutants have their numbers. `None` if the text is no Rust.
pub fn rewrite(text: &str, mutants: &[(u32, &Mutant)]) -> Option<Rewritten> {
    let file = syn::parse_file(text).ok()?;
    let starts = line_starts(text);
    let mut at: HashMap<(usize, Kind), Vec<(u32, &Mutant)>> = HashMap::new();
    for &(id, mutant) in mutants {
        let (Some(genre), Some(offset)) = (mutant.genre, offset(text, &starts, mutant.start)) else { continue };
        at.entry((offset, Kind::of(genre))).or_default().push((id, mutant));
    }
    let mut edits = Edits { text, at, done: Vec::new(), wrappers: Vec::new() };
    edits.bodies();
    edits.visit_file(&file);
    Some(edits.applied())
}

/// Genres that may begin at the same byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Kind {
    Body,
    Operator,
    Arm,
    Guard,
}

impl Kind {
    fn of(genre: Genre) -> Self {
        match genre {
            Genre::Value => Self::Body,
            Genre::Binary | Genre::Unary => Self::Operator,
            Genre::Arm => Self::Arm,
            Genre::Guard => Self::Guard,
        }
    }
}

fn line_starts(text: &str) -> Vec<usize> {
    std::iter::once(0).chain(text.match_indices('\n').map(|(i, _)| i + 1)).collect()
}

fn offset(text: &str, starts: &[usize], (line, column): (usize, usize)) -> Option<usize> {
    let start = *starts.get(line.checked_sub(1)?)?;
    let before = text[start..].chars().take(column.checked_sub(1)?);
    Some(start + before.map(char::len_utf8).sum::<usize>())
}

/// Replacement of some bytes of a file.
struct Edit {
    bytes: Range<usize>,
    text: String,
    /// Bytes of `text` that only one mutant uses.
    arms: Vec<(Range<usize>, u32)>,
    /// Wrapper that begins (`true`) or ends with this edit.
    wrapper: Option<(usize, bool)>,
}

struct Edits<'a> {
    text: &'a str,
    at: HashMap<(usize, Kind), Vec<(u32, &'a Mutant)>>,
    done: Vec<Edit>,
    wrappers: Vec<Vec<u32>>,
}

/// Text with the bytes that single mutants use.
#[derive(Default)]
struct Arms {
    text: String,
    arms: Vec<(Range<usize>, u32)>,
}

impl Arms {
    fn push(&mut self, id: u32, text: &str) {
        let start = self.text.len();
        self.text += text;
        self.arms.push((start..self.text.len(), id));
    }

    /// `if on(id) { mutant } else … { original }`
    fn choice<'m>(mutants: &[(u32, &'m Mutant)], mutated: impl Fn(&'m Mutant) -> String, original: &str) -> Self {
        let mut arms = Self::default();
        for &(id, mutant) in mutants {
            arms.push(id, &format!("if {} {{ {} }}", on(id), mutated(mutant)));
            arms.text += " else ";
        }
        let _ = write!(arms.text, "{{ {original} }}");
        arms
    }
}

fn on(id: u32) -> String {
    format!("crate::mutants__::on({id})")
}

impl<'a> Edits<'a> {
    fn take(&mut self, offset: usize, kind: Kind) -> Option<Vec<(u32, &'a Mutant)>> {
        self.at.remove(&(offset, kind))
    }

    fn replace(&mut self, bytes: Range<usize>, text: impl Into<String>) {
        self.done.push(Edit { bytes, text: text.into(), arms: Vec::new(), wrapper: None });
    }

    /// Begins a wrapper of mutants, and returns its number.
    fn open(&mut self, bytes: Range<usize>, text: &str, mutants: &[(u32, &Mutant)]) -> usize {
        let wrapper = self.wrappers.len();
        self.wrappers.push(mutants.iter().map(|&(id, _)| id).collect());
        self.done.push(Edit { bytes, text: text.into(), arms: Vec::new(), wrapper: Some((wrapper, true)) });
        wrapper
    }

    fn close(&mut self, at: usize, wrapper: usize, before: &str, arms: Arms, after: &str) {
        let shift = |(range, id): (Range<usize>, u32)| (range.start + before.len()..range.end + before.len(), id);
        self.done.push(Edit {
            bytes: at..at,
            text: format!("{before}{}{after}", arms.text),
            arms: arms.arms.into_iter().map(shift).collect(),
            wrapper: Some((wrapper, false)),
        });
    }

    /// Constants before the first statement of a body.
    fn bodies(&mut self) {
        let mut offsets: Vec<usize> =
            self.at.keys().filter(|(_, kind)| *kind == Kind::Body).map(|&(at, _)| at).collect();
        offsets.sort_unstable();
        for at in offsets {
            let mutants = self.take(at, Kind::Body).unwrap_or_default();
            let mut arms = Arms::default();
            for &(id, mutant) in &mutants {
                arms.push(id, &format!("if {} {{ return {}; }} ", on(id), mutant.replacement));
            }
            let wrapper = self.open(at..at, "", &mutants);
            self.close(at, wrapper, "", arms, "");
        }
    }

    fn applied(mut self) -> Rewritten {
        // Edits at one place stay in order: outer expressions begin first and end last.
        self.done.sort_by_key(|edit| edit.bytes.start);
        let mut out = Rewritten::default();
        let mut opened: HashMap<usize, usize> = HashMap::new();
        let mut copied = 0;
        for edit in self.done {
            out.text += &self.text[copied..edit.bytes.start];
            let start = out.text.len();
            out.text += &edit.text;
            out.arms.extend(edit.arms.into_iter().map(|(range, id)| (range.start + start..range.end + start, id)));
            match edit.wrapper {
                Some((wrapper, true)) => {
                    opened.insert(wrapper, start);
                }
                Some((wrapper, false)) => {
                    let from = opened.get(&wrapper).copied().unwrap_or(start);
                    out.wrappers.push((from..out.text.len(), self.wrappers[wrapper].clone()));
                }
                None => {}
            }
            copied = edit.bytes.end;
        }
        out.text += &self.text[copied..];
        out
    }

    /// Both operands are evaluated once, and the operator is chosen.
    fn binary(&mut self, expr: &'a ExprBinary, mutants: &[(u32, &'a Mutant)]) {
        let (left, op, right) = (bytes(&expr.left), bytes(&expr.op), bytes(&expr.right));
        let sign = &self.text[op.clone()];
        if matches!(expr.op, BinOp::And(_) | BinOp::Or(_)) {
            return self.lazy(expr, mutants);
        }
        let is_comparison = ["==", "!=", "<", ">", "<=", ">="].contains(&sign);
        let place = &self.text[left.clone()];
        let is_assignment = is_assignment(&expr.op);
        let (open, comma, close) = match (is_assignment, is_comparison) {
            (true, _) => ("match (", "", ") { r__ => "),
            (_, true) => ("(match (&(", "), &(", ")) { (l__, r__) => "),
            _ => ("(match ((", "), (", ")) { (l__, r__) => "),
        };
        let apply = |op: &str| match (is_assignment, is_comparison) {
            (true, _) => format!("{place} {op} r__"),
            (_, true) => format!("*l__ {op} *r__"),
            _ => format!("l__ {op} r__"),
        };
        let arms = Arms::choice(mutants, |mutant| apply(&mutant.replacement), &apply(sign));
        if is_assignment {
            let wrapper = self.open(left.start..right.start, open, mutants);
            self.visit_expr(&expr.right);
            self.close(right.end, wrapper, close, arms, " }");
        } else {
            let wrapper = self.open(left.start..left.start, open, mutants);
            self.visit_expr(&expr.left);
            self.replace(op, comma);
            self.visit_expr(&expr.right);
            self.close(right.end, wrapper, close, arms, " })");
        }
    }

    /// `a && b` with a switch to `a || b`, or the other way round: `b` is evaluated if `a` is the other value.
    fn lazy(&mut self, expr: &'a ExprBinary, mutants: &[(u32, &'a Mutant)]) {
        let (left, op, right) = (bytes(&expr.left), bytes(&expr.op), bytes(&expr.right));
        let wrapper = self.open(left.start..left.start, "(match (", mutants);
        self.visit_expr(&expr.left);
        let switches: Vec<String> = mutants.iter().map(|&(id, _)| on(id)).collect();
        let sign = if matches!(expr.op, BinOp::And(_)) { "!=" } else { "==" };
        self.replace(op, format!(") {{ l__ => if l__ {sign} ({}) {{", switches.join(" || ")));
        self.visit_expr(&expr.right);
        self.close(right.end, wrapper, "} else { l__ } })", Arms::default(), "");
    }
}

/// Bytes of a part of the file.
fn bytes(part: &impl Spanned) -> Range<usize> {
    part.span().byte_range()
}

fn is_assignment(op: &BinOp) -> bool {
    use BinOp::{
        AddAssign, BitAndAssign, BitOrAssign, BitXorAssign, DivAssign, MulAssign, RemAssign, ShlAssign, ShrAssign,
        SubAssign,
    };
    matches!(
        op,
        AddAssign(_)
            | SubAssign(_)
            | MulAssign(_)
            | DivAssign(_)
            | RemAssign(_)
            | BitAndAssign(_)
            | BitOrAssign(_)
            | BitXorAssign(_)
            | ShlAssign(_)
            | ShrAssign(_)
    )
}

/// Conditions with `let` cannot be moved.
fn has_let(expr: &Expr) -> bool {
    match expr {
        Expr::Let(_) => true,
        Expr::Binary(binary) => has_let(&binary.left) || has_let(&binary.right),
        _ => false,
    }
}

impl<'a> Visit<'a> for Edits<'a> {
    fn visit_expr_binary(&mut self, expr: &'a ExprBinary) {
        let can_move = !has_let(&expr.left) && !has_let(&expr.right);
        match self.take(bytes(&expr.op).start, Kind::Operator).filter(|_| can_move) {
            Some(mutants) => self.binary(expr, &mutants),
            None => visit::visit_expr_binary(self, expr),
        }
    }

    fn visit_expr_unary(&mut self, expr: &'a ExprUnary) {
        let op = bytes(&expr.op);
        let Some(mutants) = self.take(op.start, Kind::Operator) else { return visit::visit_expr_unary(self, expr) };
        let arms = Arms::choice(&mutants, |_| "x__".into(), &format!("{}x__", &self.text[op.clone()]));
        let wrapper = self.open(op, "(match (", &mutants);
        self.visit_expr(&expr.expr);
        self.close(bytes(&expr.expr).end, wrapper, ") { x__ => ", arms, " })");
    }

    fn visit_arm(&mut self, arm: &'a Arm) {
        let deleted = self.take(bytes(arm).start, Kind::Arm);
        let deleted = deleted.or_else(|| self.take(bytes(&arm.pat).start, Kind::Arm)).unwrap_or_default();
        let not_deleted: Vec<String> = deleted.iter().map(|&(id, _)| format!("!{}", on(id))).collect();
        let not_deleted = not_deleted.join(" && ");
        match &arm.guard {
            None if !deleted.is_empty() => {
                let end = bytes(&arm.pat).end;
                let wrapper = self.open(end..end, "", &deleted);
                self.close(end, wrapper, &format!(" if {not_deleted} "), Arms::default(), "");
            }
            Some((_, guard)) if !has_let(guard) => {
                let range = bytes(&**guard);
                let outer = (!deleted.is_empty())
                    .then(|| self.open(range.start..range.start, &format!("{not_deleted} && ("), &deleted));
                self.guard(guard);
                if let Some(wrapper) = outer {
                    self.close(range.end, wrapper, ")", Arms::default(), "");
                }
            }
            Some((_, guard)) => self.visit_expr(guard),
            None => {}
        }
        self.visit_expr(&arm.body);
    }
}

impl<'a> Edits<'a> {
    fn guard(&mut self, guard: &'a Expr) {
        let range = bytes(guard);
        let Some(mutants) = self.take(range.start, Kind::Guard) else { return self.visit_expr(guard) };
        let arms = Arms::choice(&mutants, |mutant| mutant.replacement.clone(), "g__");
        let wrapper = self.open(range.start..range.start, "match (", &mutants);
        self.visit_expr(guard);
        self.close(range.end, wrapper, ") { g__ => ", arms, " }");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mutant(genre: Genre, start: (usize, usize), replacement: &str) -> Mutant {
        let name = String::from("m");
        Mutant { file: "a.rs".into(), genre: Some(genre), replacement: replacement.into(), start, name }
    }

    /// New text with `on(n)` for the choice of mutant n. It parses.
    fn rewritten(text: &str, mutants: &[Mutant]) -> String {
        let numbered: Vec<(u32, &Mutant)> = (0..).zip(mutants).collect();
        let out = rewrite(text, &numbered).expect("Rust");
        syn::parse_file(&out.text).expect("Rust");
        out.text.replace("crate::mutants__::", "")
    }

    #[test]
    fn operands_are_evaluated_once() {
        let mutants = [mutant(Genre::Binary, (1, 33), "-"), mutant(Genre::Binary, (1, 37), "/")];
        assert_eq!(
            rewritten("fn f(a: f64, b: f64) -> f64 { a + b * a }", &mutants),
            "fn f(a: f64, b: f64) -> f64 { (match ((a ), ( (match ((b ), ( a)) { (l__, r__) => if on(1) { l__ / r__ } \
             else { l__ * r__ } }))) { (l__, r__) => if on(0) { l__ - r__ } else { l__ + r__ } }) }"
        );
    }

    #[test]
    fn comparisons_do_not_move() {
        let mutants = [mutant(Genre::Binary, (1, 37), "!=")];
        assert_eq!(
            rewritten("fn f(a: String, b: String) -> bool {a==b}", &[mutant(Genre::Binary, (1, 38), "!=")]),
            "fn f(a: String, b: String) -> bool {(match (&(a), &(b)) { (l__, r__) => if on(0) { *l__ != *r__ } else { \
             *l__ == *r__ } })}"
        );
        // No operator begins at this place.
        assert_eq!(
            rewritten("fn f(a: String, b: String) -> bool {a==b}", &mutants),
            "fn f(a: String, b: String) -> bool {a==b}"
        );
    }

    #[test]
    fn right_operands_of_lazy_operators_stay_lazy() {
        assert_eq!(
            rewritten("fn f(a: bool) -> bool { a && g() }", &[mutant(Genre::Binary, (1, 27), "||")]),
            "fn f(a: bool) -> bool { (match (a ) { l__ => if l__ != (on(0)) { g()} else { l__ } }) }"
        );
        // Conditions with `let` stay as they are.
        let text = "fn f(a: bool) { if a && let Some(b) = c() {} }";
        assert_eq!(rewritten(text, &[mutant(Genre::Binary, (1, 22), "||")]), text);
    }

    #[test]
    fn bodies_arms_and_guards_are_switched() {
        let text = "fn f(a: i32) -> i32 {\n    match -a {\n        0 => 1,\n        1 if a > 2 => 3,\n        _ => 4,\n    }\n}\n";
        let mutants = [
            mutant(Genre::Value, (2, 5), "0"),
            mutant(Genre::Unary, (2, 11), ""),
            mutant(Genre::Arm, (3, 9), ""),
            mutant(Genre::Arm, (4, 9), ""),
            mutant(Genre::Guard, (4, 14), "true"),
        ];
        assert_eq!(
            rewritten(text, &mutants),
            "fn f(a: i32) -> i32 {\n    if on(0) { return 0; } match (match (a) { x__ => if on(1) { x__ } else { -x__ } }) {\n        0 if \
             !on(2)  => 1,\n        1 if !on(3) && (match (a > 2) { g__ => if on(4) { true } else { g__ } }) => 3,\n        _ => \
             4,\n    }\n}\n"
        );
    }

    #[test]
    fn errors_have_their_mutants() {
        let mutants = [mutant(Genre::Binary, (1, 18), "-"), mutant(Genre::Binary, (1, 18), "*")];
        let out = rewrite("fn f() { let x = 1 + 2; }", &[(4, &mutants[0]), (5, &mutants[1])]);
        assert!(out.is_some_and(|out| out.wrappers.is_empty()), "the operator begins one column later");
        let mutants = [mutant(Genre::Binary, (1, 20), "-"), mutant(Genre::Binary, (1, 20), "*")];
        let out = rewrite("fn f() { let x = 1 + 2; }", &[(4, &mutants[0]), (5, &mutants[1])]).expect("Rust");
        let at = |text: &str| out.text.find(text).map(|start| start..start + text.len()).expect("a place");
        assert_eq!(out.mutants_at(&at("l__ * r__")), [5]);
        assert_eq!(out.mutants_at(&at("l__ + r__")), [4, 5]);
        assert_eq!(out.mutants_at(&at("let x = (match")), [4, 5]);
        assert!(out.mutants_at(&at("fn f")).is_empty());
    }
}
