//! Numbers from buffers. Nothing that a file states about them is trusted: every byte is checked to exist.

use super::document::{GltfDocument, GltfResult};
use gltf::json::accessor::{Accessor, ComponentType, GenericComponentType, IndexComponentType};
use gltf::json::validation::Checked;
use gltf::json::{Index, buffer};
use std::rc::Rc;

impl GltfDocument {
    /// Returns the items of an accessor one after the other, `N` numbers each; normalized integers as fractions. Each
    /// accessor is read once, however often it is used.
    ///
    /// # Errors
    /// Another number of components; bytes beyond a buffer; more items than any model has.
    pub fn numbers<const N: usize>(&self, index: Index<Accessor>) -> GltfResult<Rc<Vec<f64>>> {
        let shape = self.root.get(index).map(|accessor| accessor.type_);
        if let Some(known) = self.numbers.borrow().get(&index.value())
            && matches!(shape, Some(Checked::Valid(shape)) if shape.multiplicity() == N)
        {
            return Ok(Rc::clone(known));
        }
        let numbers = Rc::new(self.items::<N>(index)?.into_flattened());
        self.numbers.borrow_mut().insert(index.value(), Rc::clone(&numbers));
        Ok(numbers)
    }

    fn items<const N: usize>(&self, index: Index<Accessor>) -> GltfResult<Vec<[f64; N]>> {
        let broken = |why: &str| format!("accessor {} {why}: export the file again", index.value());
        let accessor = self.root.get(index).ok_or_else(|| broken("is missing"))?;
        let (Checked::Valid(GenericComponentType(kind)), Checked::Valid(shape)) =
            (accessor.component_type, accessor.type_)
        else {
            return Err(broken("has items of no kind"));
        };
        if shape.multiplicity() != N {
            return Err(broken(&format!("has {} numbers an item, not {N}", shape.multiplicity())));
        }
        self.take(accessor.count.0)?;
        let count = accessor.count.0 as usize;
        let item = |bytes: &[u8]| -> [f64; N] {
            std::array::from_fn(|at| component(kind, accessor.normalized, &bytes[at * kind.size()..]))
        };
        let mut items: Vec<[f64; N]> = match accessor.buffer_view {
            Some(view) => {
                let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
                self.strided(view, offset, count, N * kind.size())?.map(item).collect()
            }
            None => vec![[0.0; N]; count],
        };
        if let Some(sparse) = &accessor.sparse {
            self.take(sparse.count.0)?;
            let count = sparse.count.0 as usize;
            let Checked::Valid(IndexComponentType(index_kind)) = sparse.indices.component_type else {
                return Err(broken("has sparse indices of no kind"));
            };
            let (at, values) = (&sparse.indices, &sparse.values);
            let at = self.strided(at.buffer_view, at.byte_offset.0, count, index_kind.size())?;
            let values = self.strided(values.buffer_view, values.byte_offset.0, count, N * kind.size())?;
            for (at, value) in at.zip(values) {
                let at = component(index_kind, false, at) as usize;
                *items.get_mut(at).ok_or_else(|| broken("has a sparse index beyond its end"))? = item(value);
            }
        }
        Ok(items)
    }

    /// Returns the whole numbers of an accessor.
    pub fn indices(&self, index: Index<Accessor>) -> GltfResult<Vec<u32>> {
        Ok(self.numbers::<1>(index)?.iter().map(|number| *number as u32).collect())
    }

    /// Returns `count` items of `size` bytes from `offset` of a buffer view on, one after the other or at the view's
    /// stride. An error where they reach beyond the view, or the stride is less than `size`.
    fn strided(
        &self,
        view: Index<buffer::View>,
        offset: u64,
        count: usize,
        size: usize,
    ) -> GltfResult<impl Iterator<Item = &[u8]>> {
        let beyond = || format!("an accessor reaches beyond buffer view {}: export the file again", view.value());
        let stride = self.root.get(view).and_then(|view| view.byte_stride).map_or(size, |stride| stride.0);
        let start = usize::try_from(offset).map_err(|_| beyond())?;
        let bytes = self.view(view)?.get(start..).ok_or_else(beyond)?;
        let needed = match count.checked_sub(1) {
            Some(last) => stride.checked_mul(last).and_then(|start| start.checked_add(size)).ok_or_else(beyond)?,
            None => 0,
        };
        if stride < size || needed > bytes.len() {
            return Err(beyond());
        }
        Ok((0..count).map(move |at| &bytes[at * stride..at * stride + size]))
    }
}

/// Returns the little-endian number at the start of some bytes, of which there must be enough. With `normalized`, an
/// integer becomes 0 to 1, or −1 to 1 for signed ones.
fn component(kind: ComponentType, normalized: bool, bytes: &[u8]) -> f64 {
    let two = || [bytes[0], bytes[1]];
    let four = || [bytes[0], bytes[1], bytes[2], bytes[3]];
    let (value, most) = match kind {
        ComponentType::I8 => (f64::from(bytes[0] as i8), f64::from(i8::MAX)),
        ComponentType::U8 => (f64::from(bytes[0]), f64::from(u8::MAX)),
        ComponentType::I16 => (f64::from(i16::from_le_bytes(two())), f64::from(i16::MAX)),
        ComponentType::U16 => (f64::from(u16::from_le_bytes(two())), f64::from(u16::MAX)),
        ComponentType::U32 => (f64::from(u32::from_le_bytes(four())), f64::from(u32::MAX)),
        ComponentType::F32 => return f64::from(f32::from_le_bytes(four())),
    };
    if normalized { (value / most).max(-1.0) } else { value }
}
