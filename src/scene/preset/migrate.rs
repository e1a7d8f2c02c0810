//! Old files: which keys had other names in which version.

use super::locate::{Kind, Node};

/// A key that was renamed after a version.
struct Rename {
    /// The last version that used the old name.
    last_version: u32,
    /// Where it was; `*` stands for every item of a list.
    old: &'static str,
    /// Where it is now: another name in the same group.
    new: &'static str,
}

const RENAMES: &[Rename] = &[
    Rename { last_version: 1, old: "layers.*.bottom_m", new: "layers.*.base_m" },
    Rename { last_version: 1, old: "camera.altitude_m", new: "camera.height_m" },
    Rename { last_version: 1, old: "weather.amount", new: "weather.coverage" },
];

/// Renames the old keys of a scene in its tree; the spans still point into the file as it was written.
pub(super) fn rename_keys(scene: &mut Node, version: u32) {
    for rename in RENAMES.iter().filter(|rename| version <= rename.last_version) {
        let path: Vec<&str> = rename.old.split('.').collect();
        let name = rename.new.rsplit('.').next().unwrap_or_default();
        rename_at(scene, &path, name);
    }
}

fn rename_at(node: &mut Node, path: &[&str], new_name: &str) {
    match (&mut node.kind, path) {
        (Kind::Fields(fields), [last]) => {
            for field in fields.iter_mut().filter(|field| field.name == *last) {
                new_name.clone_into(&mut field.name);
            }
        }
        (Kind::Fields(fields), [first, rest @ ..]) => {
            for field in fields.iter_mut().filter(|field| field.name == *first) {
                rename_at(&mut field.value, rest, new_name);
            }
        }
        (Kind::List(items), ["*", rest @ ..]) => {
            for item in items {
                rename_at(item, rest, new_name);
            }
        }
        _ => {}
    }
}

/// The text with every key under its new name, and for each replacement its place in the new text and its growth.
pub(super) fn rewritten(text: &str, tree: &Node) -> (String, Vec<(usize, isize)>) {
    let mut replacements = Vec::new();
    collect(text, tree, &mut replacements);
    replacements.sort_by_key(|(span, _): &(std::ops::Range<usize>, &str)| span.start);
    let (mut new, mut growths, mut copied) = (String::with_capacity(text.len()), Vec::new(), 0);
    for (span, name) in replacements {
        new.push_str(&text[copied..span.start]);
        new.push_str(name);
        growths.push((new.len(), name.len().wrapping_sub(span.len()).cast_signed()));
        copied = span.end;
    }
    new.push_str(&text[copied..]);
    (new, growths)
}

fn collect<'a>(text: &str, node: &'a Node, replacements: &mut Vec<(std::ops::Range<usize>, &'a str)>) {
    match &node.kind {
        Kind::Fields(fields) => {
            for field in fields {
                if text[field.name_span.clone()] != field.name {
                    replacements.push((field.name_span.clone(), &field.name));
                }
                collect(text, &field.value, replacements);
            }
        }
        Kind::List(items) | Kind::Tuple(items) => items.iter().for_each(|item| collect(text, item, replacements)),
        Kind::Number | Kind::Word | Kind::Text => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_stay_in_their_group() {
        for Rename { old, new, .. } in RENAMES {
            assert_eq!(old.rsplit_once('.').map(|pair| pair.0), new.rsplit_once('.').map(|pair| pair.0), "{old}");
        }
    }

    #[test]
    fn only_the_key_itself_is_rewritten() {
        let text = "(weather: (amount: 0.5), name: \"amount: 1\")";
        let mut tree = super::super::locate::parse(text).expect("this is RON");
        rename_keys(&mut tree, 1);
        assert_eq!(rewritten(text, &tree).0, "(weather: (coverage: 0.5), name: \"amount: 1\")");
        rename_keys(&mut tree, 2);
    }
}
