//! A reader of RON's syntax that keeps positions, so that errors can name line and column of any key.
//!
//! `ron` reports where it stopped reading; a value that reads well but is out of range has no position there. This
//! module knows nothing of parameters: it turns text into a tree of spans.

use std::ops::Range;

/// Nesting beyond this is refused; a preset needs six levels.
const MAX_DEPTH: usize = 64;

/// A value and where it stands, in bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Node {
    /// The value's text.
    pub(super) span: Range<usize>,
    /// What kind of value it is.
    pub(super) kind: Kind,
}

/// The kinds of RON values that presets are made of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A number such as `-1.5e3`; also `inf` and `NaN`.
    Number,
    /// `true`, `false` or the name of a choice.
    Word,
    /// A string.
    Text,
    /// `[a, b]`.
    List(Vec<Node>),
    /// `(a, b)`, with or without a name in front.
    Tuple(Vec<Node>),
    /// `(key: value)`, with or without a name in front.
    Fields(Vec<Field>),
}

impl Kind {
    /// The kind in words.
    pub(super) fn phrase(&self) -> &'static str {
        match self {
            Self::Number => "a number",
            Self::Word => "a name",
            Self::Text => "a string",
            Self::List(_) => "a list",
            Self::Tuple(_) => "a tuple",
            Self::Fields(_) => "a group of fields",
        }
    }
}

/// One `key: value`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Field {
    /// The key.
    pub(super) name: String,
    /// Where the key stands.
    pub(super) name_span: Range<usize>,
    /// Its value.
    pub(super) value: Node,
}

/// A place where the text is not RON, and what was expected there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct SyntaxError {
    /// Byte offset.
    pub(super) at: usize,
    /// What is wrong.
    pub(super) message: String,
}

impl Node {
    /// The field of that name.
    pub(super) fn field(&self, name: &str) -> Option<&Field> {
        self.fields().iter().find(|field| field.name == name)
    }

    /// All fields; none if this is no group.
    pub(super) fn fields(&self) -> &[Field] {
        match &self.kind {
            Kind::Fields(fields) => fields,
            _ => &[],
        }
    }

    /// The value at a key path such as `layers.0.base_m`, or as much of the path as exists.
    pub(super) fn nearest(&self, path: &str) -> &Self {
        let mut node = self;
        for part in path.split('.').filter(|part| !part.is_empty()) {
            let child = match &node.kind {
                Kind::List(items) => part.parse().ok().and_then(|index: usize| items.get(index)),
                _ => node.field(part).map(|field| &field.value),
            };
            let Some(child) = child else { break };
            node = child;
        }
        node
    }
}

/// One-based line and column (in characters) of a byte offset.
pub(super) fn line_column(text: &str, offset: usize) -> (usize, usize) {
    let before = &text[..text.floor_char_boundary(offset)];
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
}

/// Reads the whole text as one value.
pub(super) fn parse(text: &str) -> Result<Node, SyntaxError> {
    let mut reader = Reader { text, at: text.len() - text.trim_start_matches('\u{feff}').len() };
    reader.space()?;
    while reader.rest().starts_with("#!") {
        let end = reader.rest().find(']').ok_or_else(|| reader.error("this attribute has no closing `]`"))?;
        reader.at += end + 1;
        reader.space()?;
    }
    let node = reader.value(0)?;
    reader.space()?;
    if reader.rest().is_empty() { Ok(node) } else { Err(reader.error("nothing may follow the closing parenthesis")) }
}

struct Reader<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Reader<'a> {
    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn error(&self, message: impl Into<String>) -> SyntaxError {
        SyntaxError { at: self.at, message: message.into() }
    }

    fn expected(&self, what: &str) -> SyntaxError {
        let found = self.rest().chars().next().map_or("the end of the file".to_owned(), |found| format!("`{found}`"));
        self.error(format!("expected {what}, found {found}"))
    }

    /// Skips white space and comments; block comments nest.
    fn space(&mut self) -> Result<(), SyntaxError> {
        loop {
            self.at = self.text.len() - self.rest().trim_start().len();
            if self.rest().starts_with("//") {
                self.at += self.rest().find('\n').unwrap_or(self.rest().len());
            } else if self.rest().starts_with("/*") {
                self.block_comment()?;
            } else {
                return Ok(());
            }
        }
    }

    fn block_comment(&mut self) -> Result<(), SyntaxError> {
        let start = self.at;
        let mut depth = 0_usize;
        loop {
            if self.rest().starts_with("/*") {
                depth += 1;
                self.at += 2;
            } else if self.rest().starts_with("*/") {
                depth -= 1;
                self.at += 2;
                if depth == 0 {
                    return Ok(());
                }
            } else if let Some(letter) = self.rest().chars().next() {
                self.at += letter.len_utf8();
            } else {
                return Err(SyntaxError { at: start, message: "this comment has no closing `*/`".to_owned() });
            }
        }
    }

    fn word(&mut self) -> &'a str {
        let rest = self.rest();
        let length = rest.find(|letter: char| !(letter.is_alphanumeric() || letter == '_')).unwrap_or(rest.len());
        self.at += length;
        &rest[..length]
    }

    fn value(&mut self, depth: usize) -> Result<Node, SyntaxError> {
        if depth > MAX_DEPTH {
            return Err(self.error(format!("more than {MAX_DEPTH} levels of parentheses")));
        }
        let start = self.at;
        let first = self.rest().chars().next().ok_or_else(|| self.expected("a value"))?;
        let kind = match first {
            '(' => self.group(depth)?,
            '[' => Kind::List(self.list(depth)?),
            '"' => self.string()?,
            'r' if self.rest().starts_with("r\"") || self.rest().starts_with("r#") => self.raw_string()?,
            '+' | '-' | '.' | '0'..='9' => self.number(),
            _ if first.is_alphabetic() || first == '_' => {
                let word = self.word();
                self.space()?;
                match (word, self.rest().starts_with('(')) {
                    ("Some", true) => return self.optional(depth),
                    (_, true) => self.group(depth)?,
                    ("inf" | "NaN" | "nan" | "infinity", _) => return Ok(self.scalar(start, word, Kind::Number)),
                    _ => return Ok(self.scalar(start, word, Kind::Word)),
                }
            }
            _ => return Err(self.expected("a value")),
        };
        Ok(Node { span: start..self.at, kind })
    }

    fn scalar(&self, start: usize, word: &str, kind: Kind) -> Node {
        Node { span: start..start + word.len(), kind }
    }

    /// `Some(value)` is the value.
    fn optional(&mut self, depth: usize) -> Result<Node, SyntaxError> {
        self.at += 1;
        self.space()?;
        let node = self.value(depth + 1)?;
        self.space()?;
        self.closing(')')?;
        Ok(node)
    }

    fn closing(&mut self, bracket: char) -> Result<(), SyntaxError> {
        if !self.rest().starts_with(bracket) {
            return Err(self.expected(&format!("`,` or `{bracket}`")));
        }
        self.at += bracket.len_utf8();
        Ok(())
    }

    fn number(&mut self) -> Kind {
        let rest = self.rest();
        let signs = rest.len() - rest.trim_start_matches(['+', '-']).len();
        let mut previous = ' ';
        let length = rest[signs..]
            .find(|letter: char| {
                let in_exponent = matches!(letter, '+' | '-') && matches!(previous, 'e' | 'E');
                previous = letter;
                !(letter.is_ascii_alphanumeric() || matches!(letter, '.' | '_') || in_exponent)
            })
            .unwrap_or(rest.len() - signs);
        self.at += signs + length;
        Kind::Number
    }

    fn string(&mut self) -> Result<Kind, SyntaxError> {
        let start = self.at;
        let mut escaped = false;
        for (offset, letter) in self.rest().char_indices().skip(1) {
            match letter {
                _ if escaped => escaped = false,
                '\\' => escaped = true,
                '"' => {
                    self.at += offset + 1;
                    return Ok(Kind::Text);
                }
                _ => {}
            }
        }
        Err(SyntaxError { at: start, message: "this string has no closing quote".to_owned() })
    }

    fn raw_string(&mut self) -> Result<Kind, SyntaxError> {
        let start = self.at;
        let hashes = self.rest()[1..].bytes().take_while(|byte| *byte == b'#').count();
        let end = format!("\"{}", "#".repeat(hashes));
        let body = self.rest().get(2 + hashes..).and_then(|body| body.find(&end));
        let body = body.ok_or_else(|| SyntaxError { at: start, message: "this raw string does not end".to_owned() })?;
        self.at += 2 + hashes + body + end.len();
        Ok(Kind::Text)
    }

    fn list(&mut self, depth: usize) -> Result<Vec<Node>, SyntaxError> {
        self.at += 1;
        self.space()?;
        let mut items = Vec::new();
        if self.rest().starts_with(']') {
            self.at += 1;
            return Ok(items);
        }
        loop {
            items.push(self.value(depth + 1)?);
            if self.ends(']')? {
                return Ok(items);
            }
        }
    }

    /// After `(`: fields if the first thing is a word with a colon, else a tuple.
    fn group(&mut self, depth: usize) -> Result<Kind, SyntaxError> {
        self.at += 1;
        self.space()?;
        if self.rest().starts_with(')') {
            self.at += 1;
            return Ok(Kind::Fields(Vec::new()));
        }
        if self.at_key()? { Ok(Kind::Fields(self.fields(depth)?)) } else { Ok(Kind::Tuple(self.tuple(depth)?)) }
    }

    fn at_key(&mut self) -> Result<bool, SyntaxError> {
        let start = self.at;
        let is_key = !self.word().is_empty() && {
            self.space()?;
            self.rest().starts_with(':')
        };
        self.at = start;
        Ok(is_key)
    }

    fn fields(&mut self, depth: usize) -> Result<Vec<Field>, SyntaxError> {
        let mut fields = Vec::new();
        loop {
            let start = self.at;
            let name = self.word();
            if name.is_empty() {
                return Err(self.expected("the name of a field or `)`"));
            }
            self.space()?;
            if !self.rest().starts_with(':') {
                return Err(self.expected(&format!("`:` after `{name}`")));
            }
            self.at += 1;
            self.space()?;
            let value = self.value(depth + 1)?;
            fields.push(Field { name: name.to_owned(), name_span: start..start + name.len(), value });
            if self.ends(')')? {
                return Ok(fields);
            }
        }
    }

    fn tuple(&mut self, depth: usize) -> Result<Vec<Node>, SyntaxError> {
        let mut items = Vec::new();
        loop {
            items.push(self.value(depth + 1)?);
            if self.ends(')')? {
                return Ok(items);
            }
        }
    }

    /// After an item: a comma, the closing bracket, or both.
    fn ends(&mut self, bracket: char) -> Result<bool, SyntaxError> {
        self.space()?;
        let comma = self.rest().starts_with(',');
        if comma {
            self.at += 1;
            self.space()?;
        }
        if self.rest().starts_with(bracket) || !comma {
            self.closing(bracket)?;
            return Ok(true);
        }
        Ok(false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_keys_in_a_text_with_everything_in_it() {
        let text = "#![enable(implicit_some)]\n// a (comment\nPreset(a: [1, (b: -2.5e-3, c: \"):\\\"\"), /* x /* y */ ] */ ],\n\
                    é: (1.0, inf, NaN,), quality: Some(High), raw: r#\"a\"b\"#,)\n";
        let node = parse(text).expect("this is RON");
        let part = |path: &str| &text[node.nearest(path).span.clone()];
        assert_eq!(part("a.1.b"), "-2.5e-3");
        assert_eq!(part("a.1.c"), "\"):\\\"\"");
        assert_eq!(part("é"), "(1.0, inf, NaN,)");
        assert_eq!(part("quality"), "High", "an option is its value");
        assert_eq!(part("raw"), "r#\"a\"b\"#");
        assert_eq!(part("a.0.nothing"), "1", "the nearest that exists");
        assert_eq!(line_column(text, node.nearest("é").span.start), (4, 4), "columns count characters");
    }

    #[test]
    fn broken_text_is_an_error_with_a_place() {
        for (text, at, word) in [
            ("(a: 1", 5, "end of the file"),
            ("(a 1)", 3, "`,`"),
            ("(a: 1, b 2)", 9, "`:`"),
            ("(a: 1 b: 2)", 6, "`,`"),
            ("(a: [1, 2)", 9, "`]`"),
            ("(a: \"x)", 4, "quote"),
            ("(a: 1) x", 7, "follow"),
            ("/* (a: 1)", 0, "*/"),
            ("", 0, "value"),
        ] {
            let error = parse(text).expect_err(text);
            assert_eq!(error.at, at, "{text}: {error:?}");
            assert!(error.message.contains(word), "{text}: {error:?}");
        }
        assert!(parse(&"(".repeat(100_000)).is_err(), "deep nesting is refused, not a stack overflow");
    }
}
