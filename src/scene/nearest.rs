//! Finds what somebody may have meant by a name that does not exist.

/// Number of single-letter insertions, removals and replacements between two words (Levenshtein 1966).
pub fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, letter) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, other) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(letter != *other);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

/// The `most` known names closest to `name`, best first. A key path also counts as near when its last part is.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>, most: usize) -> Vec<&'a str> {
    let last = |key: &str| key.rsplit('.').next().unwrap_or_default().to_lowercase();
    // Of those that are equally near by their ends the one that is nearest as a whole comes first.
    let score = |key: &str| {
        let whole = edit_distance(&key.to_lowercase(), &name.to_lowercase());
        let same_end = 1 + edit_distance(&last(key), &last(name));
        let contained = if last(name).len() > 2 && last(key).contains(&last(name)) { 2 } else { usize::MAX };
        (whole.min(same_end).min(contained), whole)
    };
    // Half of the letters wrong is no slip of the fingers.
    let limit = (last(name).chars().count() / 2).max(2);
    let mut scored: Vec<((usize, usize), &str)> = known.into_iter().map(|key| (score(key), key)).collect();
    scored.retain(|((score, _), _)| *score <= limit);
    scored.sort_by_key(|(score, _)| *score);
    scored.truncate(most);
    scored.into_iter().map(|(_, key)| key).collect()
}

/// `; did you mean a, b or c?`, or nothing.
pub fn did_you_mean<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let near = nearest(name, known, 3);
    match near.split_last() {
        None => String::new(),
        Some((only, [])) => format!("; did you mean {only}?"),
        Some((last, others)) => format!("; did you mean {} or {last}?", others.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_of_the_books() {
        assert_eq!(edit_distance("kitten", "sitting"), 3);
        assert_eq!(edit_distance("", "abc"), 3);
        assert_eq!(edit_distance("same", "same"), 0);
    }

    #[test]
    fn slips_are_found_and_nonsense_is_not() {
        let known = ["layers.0.base_m", "layers.0.top_m", "weather.coverage"];
        assert_eq!(nearest("layers.0.bse_m", known, 1), ["layers.0.base_m"]);
        assert_eq!(nearest("coverage", known, 1), ["weather.coverage"]);
        assert!(did_you_mean("xyzzyplugh", known).is_empty(), "nothing is near");
    }
}
