//! Writes `docs/parameters.md` from the declarations.

use super::edit::{Entry, keys};
use super::{Quality, Scene};

/// The page.
pub fn markdown() -> String {
    let mut page = "# Parameters\n\n\
        Every parameter of a sky and of how it is computed: key, default, what is allowed, meaning. The keys are those of\n\
        preset files (below `scene`), of `--set key=value`, and, with `quality.` in front, of quality files (below\n\
        `quality`). `0` in a key stands for the index of a list item.\n\n\
        This page is written by `nephoscope info --parameters`; do not edit it.\n"
        .to_owned();
    push_section(&mut page, "Scene", "", &keys(&Scene::default()));
    push_section(&mut page, "Quality", "quality.", &keys(&Quality::default()));
    page
}

fn push_section(page: &mut String, title: &str, prefix: &str, entries: &[Entry]) {
    page.push_str(&format!("\n## {title}\n"));
    let group_of = |entry: &Entry| entry.key.rsplit_once('.').map_or(String::new(), |(group, _)| group.to_owned());
    let mut groups: Vec<String> = Vec::new();
    for group in entries.iter().map(group_of) {
        if !groups.contains(&group) {
            groups.push(group);
        }
    }
    for group in groups {
        if !group.is_empty() {
            page.push_str(&format!("\n### {group}\n"));
        }
        page.push_str("\n| key | default | allowed | meaning |\n|---|---|---|---|\n");
        for entry in entries.iter().filter(|entry| group_of(entry) == group) {
            let Entry { key, default, allowed, doc, unit, .. } = entry;
            let default = if default.is_empty() { "none".to_owned() } else { format!("{default}{}", unit.suffix()) };
            page.push_str(&format!("| `{prefix}{key}` | {default} | {allowed} | {} |\n", doc.replace('|', "\\|")));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_in_docs_is_the_one_that_the_declarations_give() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/parameters.md");
        let page = markdown();
        if std::env::var_os("NEPHOSCOPE_UPDATE").is_some() {
            std::fs::create_dir_all(concat!(env!("CARGO_MANIFEST_DIR"), "/docs")).expect("docs/ can be made");
            std::fs::write(path, &page).expect("docs/parameters.md can be written");
        }
        let stored = std::fs::read_to_string(path).unwrap_or_default();
        assert!(
            stored == page,
            "docs/parameters.md differs from the parameters; run `NEPHOSCOPE_UPDATE=1 cargo test --lib reference_docs` \
             and commit the page"
        );
    }
}
