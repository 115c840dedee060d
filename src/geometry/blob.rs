//! Shared values, named by the hash of their content.

use foldhash::quality::FixedState;
use std::fmt::{self, Debug, Formatter};
use std::hash::{BuildHasher, Hasher};
use std::sync::{Arc, LazyLock};

/// Shared, immutable values with a hash: the executor uploads equal data once and keeps it while it is used.
#[derive(Debug, Clone)]
pub struct Blob<T> {
    data: BlobData<T>,
    len: usize,
    hash: u64,
}

/// The values, or the function that makes them when they are first asked for.
#[derive(Clone)]
enum BlobData<T> {
    Given(Arc<Vec<T>>),
    Made(Arc<LazyLock<Vec<T>, MakeValues<T>>>),
}

type MakeValues<T> = Box<dyn FnOnce() -> Vec<T> + Send + Sync>;

impl<T: Debug> Debug for BlobData<T> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            BlobData::Given(values) => values.fmt(f),
            BlobData::Made(values) => values.fmt(f),
        }
    }
}

impl<T: bytemuck::Pod> Blob<T> {
    /// Makes a blob of these values and hashes their bytes.
    pub fn new(data: Vec<T>) -> Blob<T> {
        Blob { hash: hashed(bytemuck::cast_slice(&data)), len: data.len(), data: BlobData::Given(Arc::new(data)) }
    }

    /// Makes a blob of `len` values that `make` computes when they are first asked for. Blobs with the same `identity`
    /// and length are taken for equal.
    pub fn made(identity: &[u8], len: usize, make: impl FnOnce() -> Vec<T> + Send + Sync + 'static) -> Blob<T> {
        Blob { hash: hashed(identity), len, data: BlobData::Made(Arc::new(LazyLock::new(Box::new(make)))) }
    }

    /// Returns the values; makes them first where that is still to do.
    pub fn data(&self) -> &[T] {
        match &self.data {
            BlobData::Given(values) => values,
            BlobData::Made(values) => values,
        }
    }

    /// Returns how many values there are, without making them.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Returns whether there are no values.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Returns the values as bytes.
    pub fn bytes(&self) -> &[u8] {
        bytemuck::cast_slice(self.data())
    }

    /// Returns the hash of the bytes, or of the identity of values that are made on demand. It is stable within a
    /// process only.
    pub fn hash(&self) -> u64 {
        self.hash
    }
}

impl<T> PartialEq for Blob<T> {
    fn eq(&self, other: &Blob<T>) -> bool {
        self.hash == other.hash && self.len == other.len
    }
}

fn hashed(bytes: &[u8]) -> u64 {
    let mut hasher = FixedState::default().build_hasher();
    hasher.write(bytes);
    hasher.finish()
}
