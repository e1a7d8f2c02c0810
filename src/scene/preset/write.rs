//! Writes parameters as RON, leaving out what has its default value.

use super::super::paint::Strokes;
use super::super::param::{ChoiceInfo, Colour, FileName, GroupInfo, Info, List, Params, Visitor};

/// The fields that differ from their defaults, one a line, `depth` levels in; empty when none does.
pub(super) fn fields(root: &mut impl Params, depth: usize) -> String {
    let mut writer = Writer { depth, text: String::new() };
    root.visit(&mut writer);
    writer.text
}

/// A string in quotes, with escapes.
pub(in crate::scene) fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for letter in text.chars() {
        match letter {
            '"' | '\\' => quoted.extend(['\\', letter]),
            '\n' => quoted.push_str("\\n"),
            control if control.is_control() => quoted.extend(control.escape_unicode()),
            other => quoted.push(other),
        }
    }
    quoted.push('"');
    quoted
}

struct Writer {
    depth: usize,
    text: String,
}

impl Writer {
    fn line(&mut self, text: &str) {
        self.text.push_str(&"    ".repeat(self.depth));
        self.text.push_str(text);
        self.text.push('\n');
    }

    fn field<T: PartialEq>(&mut self, info: &Info<T>, value: &T, written: String) {
        if *value != info.default {
            self.line(&format!("{}: {written},", info.name));
        }
    }

    fn nested(&self, levels: usize, visit: &mut dyn FnMut(&mut dyn Visitor)) -> String {
        let mut nested = Self { depth: self.depth + levels, text: String::new() };
        visit(&mut nested);
        nested.text
    }
}

impl Visitor for Writer {
    fn float(&mut self, info: &Info<f32>, value: &mut f32) {
        self.field(info, value, format!("{value:?}"));
    }

    fn count(&mut self, info: &Info<u32>, value: &mut u32) {
        self.field(info, value, value.to_string());
    }

    fn switch(&mut self, info: &Info<bool>, value: &mut bool) {
        self.field(info, value, value.to_string());
    }

    fn choice(&mut self, info: &ChoiceInfo, index: &mut usize) {
        if let Some([name, ..]) = info.options.get(*index).filter(|_| *index != info.default) {
            self.line(&format!("{}: {name},", info.name));
        }
    }

    fn colour(&mut self, info: &Info<Colour>, value: &mut Colour) {
        self.field(info, value, format!("({:?}, {:?}, {:?})", value.0, value.1, value.2));
    }

    fn file(&mut self, info: &Info<FileName>, value: &mut FileName) {
        self.field(info, value, quoted(&value.0));
    }

    fn strokes(&mut self, info: &Info<Strokes>, value: &mut Strokes) {
        if *value == info.default {
            return;
        }
        self.line(&format!("{}: [", info.name));
        for stroke in &value.0 {
            self.line(&format!("    {},", quoted(&stroke.to_string())));
        }
        self.line("],");
    }

    fn group(&mut self, info: &GroupInfo, children: &mut dyn FnMut(&mut dyn Visitor)) {
        let inner = self.nested(1, children);
        if !inner.is_empty() {
            self.line(&format!("{}: (", info.name));
            self.text.push_str(&inner);
            self.line("),");
        }
    }

    fn list(&mut self, info: &GroupInfo, list: &mut dyn List) {
        let items: Vec<String> =
            (0..list.count()).map(|index| self.nested(2, &mut |visitor| list.visit_item(index, visitor))).collect();
        // Every list starts with one default item.
        if items.len() == 1 && items[0].is_empty() {
            return;
        }
        self.line(&format!("{}: [", info.name));
        self.depth += 1;
        for item in items {
            if item.is_empty() {
                self.line("(),");
            } else {
                self.line("(");
                self.text.push_str(&item);
                self.line("),");
            }
        }
        self.depth -= 1;
        self.line("],");
    }
}
