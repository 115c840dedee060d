//! The module of a page, `assets/page/page.wasm`: what answers its questions, for a browser without a toolchain's help.
//!
//! JavaScript and the module share two buffers: it asks for space ([`reserve`]), writes there, and calls; what a call
//! says lies at [`answer_at`]. First each file of the frame comes ([`put`]), then all are read ([`read`]), then
//! questions are answered ([`answer`]). Each call returns the length of its answer in bytes; JavaScript looks whether
//! it is an error.

// Nothing else here is unsafe: an exported function has a name of its own in the module, which no other may have.
#![allow(unsafe_code, reason = "`no_mangle` exports a function under its name")]

use bytes::Bytes;
use std::cell::RefCell;
use stencilscope::capture::disk::MemoryFiles;
use stencilscope::page::PageFrame;

#[derive(Default)]
struct PageModule {
    input: Vec<u8>,
    output: Vec<u8>,
    files: MemoryFiles,
    frame: Option<PageFrame>,
}

thread_local! {
    static MODULE: RefCell<PageModule> = RefCell::default();
}

/// Makes space for so many bytes of input, and returns its address.
#[unsafe(no_mangle)]
pub extern "C" fn reserve(bytes: usize) -> *mut u8 {
    MODULE.with_borrow_mut(|module| {
        module.input = vec![0; bytes];
        module.input.as_mut_ptr()
    })
}

/// Returns the address of the last call's answer.
#[unsafe(no_mangle)]
pub extern "C" fn answer_at() -> *const u8 {
    MODULE.with_borrow(|module| module.output.as_ptr())
}

/// Takes a file from the input, its name in a line of its own before its bytes; the answer is empty, or says what is
/// wrong.
#[unsafe(no_mangle)]
pub extern "C" fn put() -> usize {
    respond(|module| {
        let input = Bytes::from(std::mem::take(&mut module.input));
        let end = input.iter().position(|byte| *byte == b'\n').ok_or("a file without a name")?;
        let name = str::from_utf8(&input[..end]).map_err(|error| error.to_string())?;
        module.files.insert(name.to_owned(), input.slice(end + 1..));
        Ok(String::new())
    })
}

/// Reads the frame from the files; the answer is empty, or says what is wrong.
#[unsafe(no_mangle)]
pub extern "C" fn read() -> usize {
    respond(|module| {
        let frame = PageFrame::read(&std::mem::take(&mut module.files)).map_err(|error| error.to_string())?;
        module.frame = Some(frame);
        Ok(String::new())
    })
}

/// Answers the question in the input, both JSON.
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> usize {
    respond(|module| {
        let question = std::mem::take(&mut module.input);
        let question = str::from_utf8(&question).map_err(|error| error.to_string())?;
        let frame = module.frame.as_ref().ok_or("the frame is not read yet")?;
        frame.answer(question).map_err(|error| error.to_string())
    })
}

/// Stores the answer, or `{"error": …}`, and returns its length.
fn respond(call: impl FnOnce(&mut PageModule) -> Result<String, String>) -> usize {
    MODULE.with_borrow_mut(|module| {
        let said = call(module).unwrap_or_else(|error| serde_json::json!({ "error": error }).to_string());
        module.output = said.into_bytes();
        module.output.len()
    })
}

fn main() {}
