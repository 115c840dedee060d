//! The order in which adapters are tried, for captures, the window and pictures of panels alike.

use wgpu::{Adapter, DeviceType};

/// Returns how late an adapter of this kind is tried: 0 for the fastest kind.
pub fn speed_rank(adapter: &Adapter) -> u32 {
    match adapter.get_info().device_type {
        DeviceType::DiscreteGpu => 0,
        DeviceType::IntegratedGpu => 1,
        DeviceType::VirtualGpu => 2,
        DeviceType::Other => 3,
        DeviceType::Cpu => 4,
    }
}

/// Returns what the first adapter gives that `open` succeeds with, and the errors of those before it.
///
/// # Errors
/// The first adapter's error where `open` succeeds with none; `None` where there is no adapter.
pub async fn first_that_opens<A, T, E>(
    adapters: impl IntoIterator<Item = A>,
    open: impl AsyncFn(A) -> Result<T, E>,
) -> Result<(T, Vec<E>), Option<E>> {
    let mut errors = Vec::new();
    for adapter in adapters {
        match open(adapter).await {
            Ok(opened) => return Ok((opened, errors)),
            Err(error) => errors.push(error),
        }
    }
    Err(errors.into_iter().next())
}

#[cfg(test)]
mod tests {
    use super::*;
    use pollster::block_on;

    async fn open(adapter: &str) -> Result<String, String> {
        if adapter.starts_with("broken") { Err(format!("{adapter} failed")) } else { Ok(adapter.to_owned()) }
    }

    #[test]
    fn an_adapter_that_gives_no_device_is_passed_over() {
        let (name, passed_over) =
            block_on(first_that_opens(["broken card", "llvmpipe", "another"], open)).expect("one opens");
        assert_eq!((name.as_str(), passed_over), ("llvmpipe", vec!["broken card failed".to_owned()]));
    }

    #[test]
    fn where_none_gives_a_device_the_first_says_why() {
        let error = block_on(first_that_opens(["broken first", "broken second"], open)).expect_err("none opens");
        assert_eq!(error.as_deref(), Some("broken first failed"));
        assert_eq!(block_on(first_that_opens([], open)), Err(None), "of no adapter");
    }
}
