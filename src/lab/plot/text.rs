//! Text whose font is not known: how wide it is at most, and what to do where that is too wide.

/// The width of a text in pixels, in a wide sans-serif font such as Verdana; other fonts take less.
pub(super) fn width(text: &str, size: f64) -> f64 {
    let em = |letter: char| match letter {
        'i' | 'j' | 'l' | '.' | ',' | ':' | ';' | '\'' | '|' | ' ' | 'I' => 0.4,
        'm' | 'w' | 'M' | 'W' | '@' | '%' => 1.0,
        'A'..='Z' | '+' | '=' | '<' | '>' | '~' | '#' | '_' | '&' | '^' => 0.85,
        letter if letter.is_ascii() => 0.65,
        'à'..='ö' | 'ø'..='ÿ' | 'α'..='ψ' | '°' | '²' | '³' | '·' if letter != 'æ' => 0.75,
        // Other capitals, signs and mathematics; wide scripts and pictures.
        letter if letter < '\u{2300}' => 1.0,
        _ => 1.1,
    };
    text.chars().map(em).sum::<f64>() * size
}

/// A text in at most `most` lines of that width; what does not fit ends in an ellipsis.
pub(super) fn lines(text: &str, size: f64, room: f64, most: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let mut line = String::new();
    for word in text.split_whitespace() {
        let joined = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
        if width(&joined, size) <= room || line.is_empty() {
            line = joined;
        } else {
            lines.push(std::mem::replace(&mut line, word.to_owned()));
        }
    }
    if !line.is_empty() {
        lines.push(line);
    }
    if lines.len() > most {
        let rest = lines.split_off(most.max(1) - 1).join(" ");
        lines.push(rest);
    }
    lines.into_iter().map(|line| shortened(line, size, room)).collect()
}

fn shortened(line: String, size: f64, room: f64) -> String {
    if width(&line, size) <= room {
        return line;
    }
    let mut kept = String::new();
    let room = room - width("…", size);
    for letter in line.chars() {
        kept.push(letter);
        if width(&kept, size) > room {
            kept.pop();
            break;
        }
    }
    format!("{}…", kept.trim_end())
}

/// Text as it may stand in XML 1.0, in elements and in attributes.
pub(super) fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            // XML has no way to write most control characters, nor these two.
            '\u{fffe}' | '\u{ffff}' => safe.push(' '),
            letter if letter.is_control() => safe.push(' '),
            letter => safe.push(letter),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_keep_to_their_room() {
        let text =
            "Relative error of the converged reference over counted samples per pixel and counterrevolutionaries";
        for room in [60.0, 120.0, 300.0, 5000.0] {
            for most in 1..=3 {
                let lines = lines(text, 13.0, room, most);
                assert!((1..=most).contains(&lines.len()), "{lines:?}");
                assert!(lines.iter().all(|line| width(line, 13.0) <= room), "{room}: {lines:?}");
                let whole = lines.join(" ") == text;
                assert!(whole || lines.iter().any(|line| line.ends_with('…')), "{room}, {most}: {lines:?}");
            }
        }
        assert_eq!(lines(text, 13.0, 5000.0, 2), [text]);
        assert_eq!(lines(" ", 13.0, 100.0, 2), Vec::<String>::new());
    }

    #[test]
    fn no_letter_breaks_the_document() {
        assert_eq!(escaped("a<b> & \"c\"\u{1}\n"), "a&lt;b&gt; &amp; &quot;c&quot;  ");
    }
}
