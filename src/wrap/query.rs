use wgpu::custom::QuerySetInterface;

/// A wrapped query set: hands each call to the real one.
#[derive(Debug)]
pub struct QuerySet {
    pub inner: wgpu::QuerySet,
}

impl QuerySetInterface for QuerySet {
    fn destroy(&self) {
        self.inner.destroy();
    }
}
