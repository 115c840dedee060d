use wgpu::custom::QuerySetInterface;

#[derive(Debug)]
pub struct QuerySet {
    pub inner: wgpu::QuerySet,
}

impl QuerySetInterface for QuerySet {
    fn destroy(&self) {
        self.inner.destroy();
    }
}
