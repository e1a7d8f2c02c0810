//! Compares the syntax tree of a file with the declared parameters: names, types and ranges, each fault with its place.

use super::super::bounds::{Fault, colour_fault, count_fault, float_fault};
use super::super::nearest::did_you_mean;
use super::super::paint::Strokes;
use super::super::param::{ChoiceInfo, Colour, FileName, GroupInfo, Info, List, Params, Visitor};
use super::locate::{Kind, Node};

/// More items than this are not looked at one by one; [`super::super::Scene::problems`] refuses far fewer.
const MAX_ITEMS: usize = 64;

/// The first thing wrong with a tree.
#[derive(Debug)]
pub(super) struct Finding {
    /// Byte offset in the file.
    pub(super) at: usize,
    /// What it is.
    pub(super) what: What,
}

/// What is wrong.
#[derive(Debug)]
pub(super) enum What {
    /// A number outside its range.
    Value(Fault),
    /// A value of another type than the parameter's: key, what is there, what was expected.
    Type(String, String, String),
    /// A field that does not exist: key and suggestions.
    Unknown(String, String),
}

/// The first fault of the group at `node`, whose key is `prefix`.
pub(super) fn check(root: &mut impl Params, text: &str, node: &Node, prefix: &str) -> Option<Finding> {
    let mut check = Check { text, node, prefix: prefix.to_owned(), names: Vec::new(), finding: None };
    if !check.is_group() {
        return check.finding;
    }
    root.visit(&mut check);
    check.finish()
}

struct Check<'a> {
    text: &'a str,
    node: &'a Node,
    prefix: String,
    names: Vec<&'static str>,
    finding: Option<Finding>,
}

impl<'a> Check<'a> {
    fn key(&self, name: &str) -> String {
        if self.prefix.is_empty() { name.to_owned() } else { format!("{}.{name}", self.prefix) }
    }

    fn child(&mut self, name: &'static str) -> Option<&'a Node> {
        self.names.push(name);
        self.node.field(name).map(|field| &field.value)
    }

    fn report(&mut self, node: &Node, what: What) {
        self.finding.get_or_insert(Finding { at: node.span.start, what });
    }

    fn wrong_type(&mut self, node: &Node, key: String, expected: impl Into<String>) {
        let found = match node.kind {
            Kind::Number | Kind::Word => format!("`{}`", &self.text[node.span.clone()]),
            _ => node.kind.phrase().to_owned(),
        };
        self.report(node, What::Type(key, found, expected.into()));
    }

    fn is_group(&mut self) -> bool {
        let is_group = matches!(self.node.kind, Kind::Fields(_));
        if !is_group {
            self.wrong_type(self.node, self.prefix.clone(), "a group such as `(field: value)`");
        }
        is_group
    }

    /// The value as `ron` reads it.
    fn read<T: serde::de::DeserializeOwned>(&self, node: &Node) -> Option<T> {
        ron::from_str(&self.text[node.span.clone()]).ok()
    }

    /// Reports what was not visited, then gives the first finding.
    fn finish(mut self) -> Option<Finding> {
        if self.finding.is_none()
            && let Some(field) = self.node.fields().iter().find(|field| !self.names.contains(&field.name.as_str()))
        {
            let hint = did_you_mean(&field.name, self.names.iter().copied());
            let what = What::Unknown(self.key(&field.name), hint);
            self.finding = Some(Finding { at: field.name_span.start, what });
        }
        self.finding
    }

    fn nested(&mut self, node: &'a Node, prefix: String, visit: &mut dyn FnMut(&mut dyn Visitor)) {
        let mut nested = Check { text: self.text, node, prefix, names: Vec::new(), finding: None };
        if nested.is_group() {
            visit(&mut nested);
        }
        if let Some(finding) = nested.finish() {
            self.finding.get_or_insert(finding);
        }
    }
}

impl Visitor for Check<'_> {
    fn float(&mut self, info: &Info<f32>, _: &mut f32) {
        let Some(node) = self.child(info.name) else { return };
        let key = self.key(info.name);
        match self.read(node).filter(|_| node.kind == Kind::Number) {
            None => self.wrong_type(node, key, "a number"),
            Some(value) => {
                if let Some(fault) = float_fault(&key, info, value) {
                    self.report(node, What::Value(fault));
                }
            }
        }
    }

    fn count(&mut self, info: &Info<u32>, _: &mut u32) {
        let Some(node) = self.child(info.name) else { return };
        let key = self.key(info.name);
        match self.read(node).filter(|_| node.kind == Kind::Number) {
            None => self.wrong_type(node, key, "a whole number"),
            Some(value) => {
                if let Some(fault) = count_fault(&key, info, value) {
                    self.report(node, What::Value(fault));
                }
            }
        }
    }

    fn switch(&mut self, info: &Info<bool>, _: &mut bool) {
        let Some(node) = self.child(info.name) else { return };
        if self.read::<bool>(node).is_none() {
            self.wrong_type(node, self.key(info.name), "true or false");
        }
    }

    fn choice(&mut self, info: &ChoiceInfo, _: &mut usize) {
        let Some(node) = self.child(info.name) else { return };
        let word = &self.text[node.span.clone()];
        let names = || info.options.iter().map(|[name, ..]| *name);
        if node.kind != Kind::Word || !names().any(|name| name == word) {
            let names: Vec<&str> = names().collect();
            self.wrong_type(node, self.key(info.name), format!("one of {}", names.join(", ")));
        }
    }

    fn colour(&mut self, info: &Info<Colour>, _: &mut Colour) {
        let Some(node) = self.child(info.name) else { return };
        let key = self.key(info.name);
        match self.read(node).filter(|_| matches!(node.kind, Kind::Tuple(_))) {
            None => self.wrong_type(node, key, "a colour such as (1.0, 0.9, 0.8)"),
            Some(value) => {
                if let Some(fault) = colour_fault(&key, value) {
                    self.report(node, What::Value(fault));
                }
            }
        }
    }

    fn file(&mut self, info: &Info<FileName>, _: &mut FileName) {
        let Some(node) = self.child(info.name) else { return };
        if node.kind != Kind::Text {
            self.wrong_type(node, self.key(info.name), "a file name in quotes");
        }
    }

    fn strokes(&mut self, info: &Info<Strokes>, _: &mut Strokes) {
        let Some(node) = self.child(info.name) else { return };
        if let Err(error) = ron::from_str::<Strokes>(&self.text[node.span.clone()]) {
            self.wrong_type(node, self.key(info.name), format!("strokes of the brush ({})", error.code));
        }
    }

    fn group(&mut self, info: &GroupInfo, children: &mut dyn FnMut(&mut dyn Visitor)) {
        let Some(node) = self.child(info.name) else { return };
        self.nested(node, self.key(info.name), children);
    }

    fn list(&mut self, info: &GroupInfo, list: &mut dyn List) {
        let Some(node) = self.child(info.name) else { return };
        let key = self.key(info.name);
        let Kind::List(items) = &node.kind else {
            self.wrong_type(node, key, "a list such as [(field: value)]");
            return;
        };
        for (index, item) in items.iter().take(MAX_ITEMS).enumerate() {
            if list.count() <= index {
                list.append();
            }
            self.nested(item, format!("{key}.{index}"), &mut |visitor| list.visit_item(index, visitor));
        }
    }
}
