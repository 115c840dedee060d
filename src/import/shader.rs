//! The effects of a fragment shader, read from what the program gave to the API: the text of GLSL, the code of SPIR-V.
//!
//! Nothing is run and no branch is followed: a shader that can discard in some case may discard.

use super::preprocessor::compiled;
use super::raw::RawFragment;
use crate::plan::ShaderEffect;

/// Returns whether a fragment shader may discard or write depth. `encoding` is RenderDoc's name of its language: GLSL
/// and SPIR-V are read, any other is unknown.
pub fn read(encoding: &str, bytes: &[u8]) -> RawFragment {
    let [discards, depth] = match encoding {
        "GLSL" => glsl(&String::from_utf8_lossy(bytes)),
        "SPIRV" | "OpenGLSPIRV" => spirv(bytes),
        _ => [ShaderEffect::Unknown; 2],
    };
    RawFragment { may_discard: discards, writes_depth: depth }
}

const fn may(does: bool) -> ShaderEffect {
    if does { ShaderEffect::Yes } else { ShaderEffect::No }
}

/// Returns whether a GLSL shader may discard (`discard`, `gl_SampleMask`) and may write depth (`gl_FragDepth`): whether
/// these words occur outside comments in what its preprocessor leaves, and not where they are declared alone
/// (`out float gl_FragDepth;`).
fn glsl(text: &str) -> [ShaderEffect; 2] {
    let code = compiled(&without_comments(text));
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    let has = |word: &str| {
        code.match_indices(word).any(|(at, _)| {
            let (before, after) = (&code[..at], &code[at + word.len()..]);
            let is_whole = !before.ends_with(is_part) && !after.starts_with(is_part);
            let is_declaration = word != "discard" && after.trim_start().starts_with(';');
            is_whole && !is_declaration
        })
    };
    [may(has("discard") || has("gl_SampleMask")), may(has("gl_FragDepth") || has("gl_FragDepthEXT"))]
}

fn without_comments(text: &str) -> String {
    let mut code = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find("//").into_iter().chain(rest.find("/*")).min() {
        code.push_str(&rest[..at]);
        code.push(' ');
        let after = &rest[at + 2..];
        // The end of a line stays: a directive ends there.
        rest = match rest[at..].starts_with("//") {
            true => after.find('\n').map_or("", |end| &after[end..]),
            false => after.find("*/").map_or("", |end| &after[end + 2..]),
        };
    }
    code.push_str(rest);
    code
}

/// Returns whether a SPIR-V shader may discard and may write depth, by its instructions; both unknown where the words
/// are no whole SPIR-V module.
fn spirv(bytes: &[u8]) -> [ShaderEffect; 2] {
    const MAGIC: u32 = 0x0723_0203;
    const HEADER: usize = 5;
    const EXECUTION_MODE: u32 = 16;
    const DECORATE: u32 = 71;
    const DEPTH_REPLACING: u32 = 12;
    const BUILT_IN: u32 = 11;
    const SAMPLE_MASK: u32 = 20;
    /// OpKill, OpTerminateInvocation, OpDemoteToHelperInvocation.
    const DISCARDS: [u32; 3] = [252, 4416, 5380];
    let words: Vec<u32> = bytes.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word)).collect();
    if words.first() != Some(&MAGIC) {
        return [ShaderEffect::Unknown; 2];
    }
    let [mut discards, mut depth] = [false; 2];
    let mut rest = words.get(HEADER..).unwrap_or_default();
    while let Some(&first) = rest.first() {
        let (operation, length) = (first & 0xffff, (first >> 16) as usize);
        let Some(instruction) = rest.get(..length).filter(|instruction| !instruction.is_empty()) else {
            return [ShaderEffect::Unknown; 2];
        };
        discards |= DISCARDS.contains(&operation);
        discards |= operation == DECORATE && instruction.get(2..4) == Some(&[BUILT_IN, SAMPLE_MASK]);
        depth |= operation == EXECUTION_MODE && instruction.get(2) == Some(&DEPTH_REPLACING);
        rest = &rest[length..];
    }
    [may(discards), may(depth)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_glsl_count_outside_comments() {
        let read = |text: &str| read("GLSL", text.as_bytes());
        let none = RawFragment { may_discard: ShaderEffect::No, writes_depth: ShaderEffect::No };
        assert_eq!(read("void main() { gl_FragColor = vec4(1); } // discard\n/* gl_FragDepth */ int discarded;"), none);
        assert_eq!(read("if (a < 0.5) discard;").may_discard, ShaderEffect::Yes);
        assert_eq!(read("/* a // b */ gl_FragDepth = 1.0;").writes_depth, ShaderEffect::Yes);
        assert_eq!(read("layout(depth_any) out float gl_FragDepth ;\nvoid main() {}"), none);
        assert_eq!(read("out float gl_FragDepth; void main() { gl_FragDepth = 0.5; }").writes_depth, ShaderEffect::Yes);
        assert_eq!(read("// an end without a line"), none);
        assert_eq!(read("/* never closed discard"), none);
        // As RenderDoc joins the texts that a shader is given in, and an engine its kinds of materials.
        let of_engine =
            "// file 0 //\n#version 330\n#define OPAQUE\n#if defined(SCISSOR) // SCISSOR\ndiscard;\n#endif\n";
        assert_eq!(read(of_engine), none);
        assert_eq!(read(&of_engine.replace("SCISSOR", "OPAQUE")).may_discard, ShaderEffect::Yes);
    }

    #[test]
    fn instructions_of_spirv_are_found() {
        let module = |instructions: &[u32]| {
            let words = [&[0x0723_0203, 0x1_0000, 0, 9, 0], instructions].concat();
            read("SPIRV", &words.into_iter().flat_map(u32::to_le_bytes).collect::<Vec<u8>>())
        };
        assert_eq!(module(&[]), RawFragment { may_discard: ShaderEffect::No, writes_depth: ShaderEffect::No });
        assert_eq!(module(&[1 << 16 | 252]).may_discard, ShaderEffect::Yes);
        assert_eq!(module(&[3 << 16 | 16, 4, 12]).writes_depth, ShaderEffect::Yes);
        assert_eq!(module(&[3 << 16 | 16, 4, 7, 1 << 16 | 253]).may_discard, ShaderEffect::No);
    }

    #[test]
    fn broken_code_is_unknown() {
        let unknown = RawFragment { may_discard: ShaderEffect::Unknown, writes_depth: ShaderEffect::Unknown };
        let broken = [&0x0723_0203_u32.to_le_bytes()[..], &[0; 16], &[252, 0, 0, 0]].concat();
        for bytes in [&broken[..], b"", b"text"] {
            assert_eq!(read("SPIRV", bytes), unknown);
        }
        assert_eq!(read("DXBC", b"DXBC"), unknown);
    }
}
