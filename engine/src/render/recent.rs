//! What was made for a key lately, kept for as long as there is room.

/// Values by key, the one used last at the end.
#[derive(Debug)]
pub struct Recent<K, V> {
    room: usize,
    entries: Vec<Entry<K, V>>,
}

#[derive(Debug)]
struct Entry<K, V> {
    key: K,
    size: usize,
    value: V,
}

impl<K: PartialEq, V> Recent<K, V> {
    /// Values whose sizes add up to no more than `room`; the one used last stays whatever its size.
    pub fn new(room: usize) -> Self {
        Self { room, entries: Vec::new() }
    }

    /// The value of a key; made, with its size, where it is not there.
    pub fn get_or_make<E>(&mut self, key: K, make: impl FnOnce(&K) -> Result<(V, usize), E>) -> Result<&V, E> {
        match self.entries.iter().position(|entry| entry.key == key) {
            Some(index) => self.entries[index..].rotate_left(1),
            None => {
                let (value, size) = make(&key)?;
                let mut held: usize = self.entries.iter().map(|entry| entry.size).sum();
                while !self.entries.is_empty() && held + size > self.room {
                    held -= self.entries.remove(0).size;
                }
                self.entries.push(Entry { key, size, value });
            }
        }
        Ok(&self.entries[self.entries.len() - 1].value)
    }

    pub fn len(&self) -> usize {
        self.entries.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn get(recent: &mut Recent<u32, u32>, key: u32, made: &mut Vec<u32>) -> u32 {
        let make = |key: &u32| {
            made.push(*key);
            Ok::<_, ()>((10 * key, 1))
        };
        *recent.get_or_make(key, make).unwrap()
    }

    #[test]
    fn what_was_used_longest_ago_makes_room() {
        let (mut recent, mut made) = (Recent::new(2), Vec::new());
        let values: Vec<u32> = [1, 2, 1, 3, 1, 2].map(|key| get(&mut recent, key, &mut made)).into();
        assert_eq!(values, [10, 20, 10, 30, 10, 20]);
        assert_eq!((made, recent.len()), (vec![1, 2, 3, 2], 2));
    }

    #[test]
    fn a_value_larger_than_the_room_is_kept_alone() {
        let mut recent = Recent::new(5);
        for size in [2, 3, 9] {
            recent.get_or_make(size, |size| Ok::<_, ()>((*size, *size))).unwrap();
        }
        assert_eq!(recent.len(), 1);
    }
}
