//! Warnings of the reader: each kind once, with its first place and how often it occurred.

#[derive(Debug, Default)]
pub(super) struct Warnings {
    entries: Vec<Entry>,
}

#[derive(Debug)]
struct Entry {
    text: String,
    first_place: String,
    count: usize,
}

/// More kinds than this are only counted: the texts may hold names from the file.
const MAX_KINDS: usize = 64;

impl Warnings {
    pub fn add(&mut self, text: impl Into<String>, place: impl Into<String>) {
        let mut text = text.into();
        if self.entries.len() >= MAX_KINDS {
            text = String::from("further warnings");
        }
        match self.entries.iter_mut().find(|entry| entry.text == text) {
            Some(entry) => entry.count += 1,
            None => self.entries.push(Entry { text, first_place: place.into(), count: 1 }),
        }
    }

    /// One line for each kind, without the file.
    pub fn lines(&self) -> Vec<String> {
        let line = |entry: &Entry| {
            let times = if entry.count > 1 { format!(" ({} times)", entry.count) } else { String::new() };
            format!("{}: {}{times}", entry.first_place, entry.text)
        };
        self.entries.iter().map(line).collect()
    }
}
