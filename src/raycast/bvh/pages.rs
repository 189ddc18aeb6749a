//! Where hierarchies lie in memory.

use std::marker::PhantomData;
use std::ops::{Deref, DerefMut};

use bytemuck::{Pod, cast_slice, cast_slice_mut};
use memmap2::MmapMut;

use super::node::{Child, Word};
use crate::raycast::RaycastError;

/// A row of numbers, zero at first, in large pages where the system has such: a ray that strays through a large hierarchy looks at a hundred
/// places in it, and to find out in which page each of them is takes as long as to read it. Pages that are never looked at take no memory.
pub struct Pages<T> {
    map: MmapMut,
    length: usize,
    numbers: PhantomData<T>,
}

impl<T: Pod> Pages<T> {
    /// # Errors
    /// If there is no memory.
    pub fn zeroed(length: usize) -> Result<Self, RaycastError> {
        let bytes = length.saturating_mul(size_of::<T>());
        // A map of nothing is refused.
        let map = MmapMut::map_anon(bytes.max(1)).map_err(|_| RaycastError::Memory { bytes })?;
        // Without them it is slower, no more.
        #[cfg(target_os = "linux")]
        let _ = map.advise(memmap2::Advice::HugePage);
        Ok(Self { map, length, numbers: PhantomData })
    }
}

impl<T: Pod> Deref for Pages<T> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        cast_slice(&self.map[..self.length * size_of::<T>()])
    }
}

impl<T: Pod> DerefMut for Pages<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        cast_slice_mut(&mut self.map[..self.length * size_of::<T>()])
    }
}

/// Nodes and blocks, one after the other.
pub struct Arena {
    pages: Pages<Word>,
    length: usize,
}

impl Arena {
    /// Empty, with room for so many words before it is moved.
    ///
    /// # Errors
    /// If there is no memory.
    pub fn with_room(words: usize) -> Result<Self, RaycastError> {
        Ok(Self { pages: Pages::zeroed(words)?, length: 0 })
    }

    #[inline(always)]
    pub fn words(&self) -> &[Word] {
        &self.pages[..self.length]
    }

    pub fn words_mut(&mut self) -> &mut [Word] {
        &mut self.pages[..self.length]
    }

    /// Appends `words`, and says where they begin.
    ///
    /// # Errors
    /// If there is no memory for them, or no name for their place.
    pub fn push(&mut self, words: &[Word]) -> Result<usize, RaycastError> {
        let (start, end) = (self.length, self.length + words.len());
        if end > Child::LIMIT {
            let limit = Child::LIMIT * size_of::<Word>();
            return Err(RaycastError::Hierarchy { message: format!("it becomes larger than {limit} bytes") });
        }
        if end > self.pages.len() {
            let mut pages = Pages::zeroed(2 * end)?;
            pages[..start].copy_from_slice(self.words());
            self.pages = pages;
        }
        self.pages[start..end].copy_from_slice(words);
        self.length = end;
        Ok(start)
    }

    /// Forgets all words from `length` on.
    pub fn truncate(&mut self, length: usize) {
        self.length = self.length.min(length);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_that_there_is_not_is_told_of() {
        for length in [usize::MAX / 16, usize::MAX] {
            let Err(RaycastError::Memory { bytes }) = Pages::<Word>::zeroed(length).map(|_| ()) else {
                panic!("{length} words?");
            };
            assert_eq!(bytes, length.saturating_mul(size_of::<Word>()));
        }
    }
}
