//! A vertex shader that writes down where its vertices land: the entry point becomes a function that a new one calls.
//!
//! ```text
//! fn vs(…same inputs…, vertex, instance) -> …same outputs… {
//!     let result = inner(…);
//!     note(result.position, vertex, instance);
//!     return result;
//! }
//! ```

use naga::{
    AddressSpace, Arena, AtomicFunction, BinaryOperator, Binding, Block, BuiltIn, EntryPoint, Expression, Function,
    FunctionArgument, GlobalVariable, Handle, Literal, Module, ResourceBinding, Scalar, ShaderStage, Span, Statement,
    StorageAccess, StructMember, Type, TypeInner, VectorSize,
};
use std::collections::BTreeSet;

/// Bytes of the log before its records: the count, padded.
pub const HEAD: u64 = 16;
/// Bytes of a record: a position, the vertex, the instance, padding.
pub const RECORD: u64 = 32;

/// A module with a vertex entry point that writes a log.
#[derive(Debug)]
pub struct Logging {
    pub module: Module,
    pub entry_point: String,
    /// Group and binding of what the entry point reads.
    pub bindings: BTreeSet<(u32, u32)>,
}

/// The vertex entry point of that name, or the only one, with a log in a group of its own.
///
/// # Errors
/// Why it can't be rewritten.
pub fn vertex_log(module: &Module, name: Option<&str>, group: u32) -> Result<Logging, &'static str> {
    let mut module = module.clone();
    let is_meant =
        |entry: &EntryPoint| entry.stage == ShaderStage::Vertex && name.is_none_or(|name| entry.name == name);
    let entry = module.entry_points.iter().find(|entry| is_meant(entry)).cloned();
    let mut entry = entry.ok_or("its shader has no such vertex entry point")?;
    let before = used(&module, &entry)?;
    if before.writes {
        return Err("its vertex shader writes to storage, and must not run twice");
    }
    module.entry_points.clear();
    let note = note(&mut module, group);
    entry.function = calling(&mut module, &entry.function, note).ok_or("its vertex shader has no position")?;
    let entry_point = entry.name.clone();
    module.entry_points.push(entry);
    validated(&module).map_err(|_| "its vertex shader can't be rewritten")?;
    Ok(Logging { module, entry_point, bindings: before.bindings })
}

fn validated(module: &Module) -> Result<naga::valid::ModuleInfo, Box<naga::WithSpan<naga::valid::ValidationError>>> {
    let (flags, capabilities) = (naga::valid::ValidationFlags::all(), naga::valid::Capabilities::all());
    naga::valid::Validator::new(flags, capabilities).validate(module).map_err(Box::new)
}

struct Used {
    bindings: BTreeSet<(u32, u32)>,
    writes: bool,
}

/// What an entry point reads and writes.
fn used(module: &Module, entry: &EntryPoint) -> Result<Used, &'static str> {
    let info = validated(module).map_err(|_| "its shader is not valid")?;
    let index = module.entry_points.iter().position(|one| one.name == entry.name && one.stage == entry.stage);
    let info = info.get_entry_point(index.ok_or("its shader has no such entry point")?);
    let mut used = Used { bindings: BTreeSet::new(), writes: false };
    for (handle, variable) in module.global_variables.iter() {
        let usage = info[handle];
        if let (false, Some(binding)) = (usage.is_empty(), variable.binding) {
            used.bindings.insert((binding.group, binding.binding));
            used.writes |= usage.intersects(naga::valid::GlobalUse::WRITE | naga::valid::GlobalUse::ATOMIC);
        }
    }
    Ok(used)
}

fn add_type(module: &mut Module, inner: TypeInner) -> Handle<Type> {
    module.types.insert(Type { name: None, inner }, Span::UNDEFINED)
}

fn member(name: &str, ty: Handle<Type>, offset: u32) -> StructMember {
    StructMember { name: Some(name.to_owned()), ty, binding: None, offset }
}

/// `fn note(position, vertex, instance)`: appends a record while there is room, and counts on when there is none.
fn note(module: &mut Module, group: u32) -> Handle<Function> {
    let unsigned = add_type(module, TypeInner::Scalar(Scalar::U32));
    let counter = add_type(module, TypeInner::Atomic(Scalar::U32));
    let position = add_type(module, TypeInner::Vector { size: VectorSize::Quad, scalar: Scalar::F32 });
    let members =
        vec![member("position", position, 0), member("vertex", unsigned, 16), member("instance", unsigned, 20)];
    let record =
        Type { name: Some("StencilscopeRecord".into()), inner: TypeInner::Struct { members, span: RECORD as u32 } };
    let record = module.types.insert(record, Span::UNDEFINED);
    let records = TypeInner::Array { base: record, size: naga::ArraySize::Dynamic, stride: RECORD as u32 };
    let records = add_type(module, records);
    let members = vec![member("count", counter, 0), member("records", records, HEAD as u32)];
    let span = (HEAD + RECORD) as u32;
    let log = Type { name: Some("StencilscopeLog".into()), inner: TypeInner::Struct { members, span } };
    let log = module.types.insert(log, Span::UNDEFINED);
    let variable = GlobalVariable {
        name: Some("stencilscope_log".into()),
        space: AddressSpace::Storage { access: StorageAccess::LOAD | StorageAccess::STORE },
        binding: Some(ResourceBinding { group, binding: 0 }),
        ty: log,
        init: None,
        memory_decorations: naga::MemoryDecorations::empty(),
    };
    let variable = module.global_variables.append(variable, Span::UNDEFINED);
    let argument = |name: &str, ty| FunctionArgument { name: Some(name.to_owned()), ty, binding: None };
    let arguments = vec![argument("position", position), argument("vertex", unsigned), argument("instance", unsigned)];
    let mut function = Function { name: Some("stencilscope_note".into()), arguments, ..Function::default() };
    let mut code = Code { expressions: &mut function.expressions, body: Block::new() };
    let [position, vertex, instance] = [0, 1, 2].map(|index| code.plain(Expression::FunctionArgument(index)));
    let log = code.plain(Expression::GlobalVariable(variable));
    let one = code.plain(Expression::Literal(Literal::U32(1)));
    let count = code.emitted(Expression::AccessIndex { base: log, index: 0 });
    let at = code.plain(Expression::AtomicResult { ty: unsigned, comparison: false });
    code.push(Statement::Atomic { pointer: count, fun: AtomicFunction::Add, value: one, result: Some(at) });
    let records = code.emitted(Expression::AccessIndex { base: log, index: 1 });
    let room = code.emitted(Expression::ArrayLength(records));
    let fits = code.emitted(Expression::Binary { op: BinaryOperator::Less, left: at, right: room });
    let outer = std::mem::replace(&mut code.body, Block::new());
    let pointer = code.emitted(Expression::Access { base: records, index: at });
    let components = vec![position, vertex, instance];
    let value = code.emitted(Expression::Compose { ty: record, components });
    code.push(Statement::Store { pointer, value });
    let accept = std::mem::replace(&mut code.body, outer);
    code.push(Statement::If { condition: fits, accept, reject: Block::new() });
    code.push(Statement::Return { value: None });
    function.body = code.body;
    module.functions.append(function, Span::UNDEFINED)
}

/// A function's code in the making.
struct Code<'a> {
    expressions: &'a mut Arena<Expression>,
    body: Block,
}

impl Code<'_> {
    /// An expression that is there without being computed.
    fn plain(&mut self, expression: Expression) -> Handle<Expression> {
        self.expressions.append(expression, Span::UNDEFINED)
    }

    /// An expression that is computed here.
    fn emitted(&mut self, expression: Expression) -> Handle<Expression> {
        let before = self.expressions.len();
        let handle = self.plain(expression);
        let range = self.expressions.range_from(before);
        self.push(Statement::Emit(range));
        handle
    }

    fn push(&mut self, statement: Statement) {
        self.body.push(statement, Span::UNDEFINED);
    }
}

/// Where an entry point has a built-in value: an argument or result of its own, or a member of one.
enum Place {
    Whole(u32),
    Member(u32, u32),
}

fn place(module: &Module, index: u32, ty: Handle<Type>, binding: Option<&Binding>, wanted: BuiltIn) -> Option<Place> {
    let is_wanted = |binding: Option<&Binding>| matches!(binding, Some(Binding::BuiltIn(of)) if is_same(*of, wanted));
    if is_wanted(binding) {
        return Some(Place::Whole(index));
    }
    let TypeInner::Struct { members, .. } = &module.types[ty].inner else { return None };
    let member = members.iter().position(|member| is_wanted(member.binding.as_ref()))?;
    Some(Place::Member(index, member as u32))
}

/// Positions may be invariant, or not.
fn is_same(built_in: BuiltIn, wanted: BuiltIn) -> bool {
    std::mem::discriminant(&built_in) == std::mem::discriminant(&wanted)
}

/// A function in place of an entry point's, that calls it and notes what comes out; `None` where no position does.
fn calling(module: &mut Module, entry: &Function, note: Handle<Function>) -> Option<Function> {
    let result = entry.result.clone()?;
    let position = place(module, 0, result.ty, result.binding.as_ref(), BuiltIn::Position { invariant: false })?;
    let mut inner = entry.clone();
    inner.name = Some("stencilscope_inner".into());
    inner.arguments.iter_mut().for_each(|argument| argument.binding = None);
    inner.result.iter_mut().for_each(|result| result.binding = None);
    let inner = module.functions.append(inner, Span::UNDEFINED);
    let mut arguments = entry.arguments.clone();
    let unsigned = add_type(module, TypeInner::Scalar(Scalar::U32));
    let mut number = |wanted: BuiltIn, name: &str| {
        let found = (0..)
            .zip(&arguments)
            .find_map(|(index, argument)| place(module, index, argument.ty, argument.binding.as_ref(), wanted));
        found.unwrap_or_else(|| {
            let binding = Some(Binding::BuiltIn(wanted));
            arguments.push(FunctionArgument { name: Some(name.to_owned()), ty: unsigned, binding });
            Place::Whole(arguments.len() as u32 - 1)
        })
    };
    let numbers =
        [number(BuiltIn::VertexIndex, "stencilscope_vertex"), number(BuiltIn::InstanceIndex, "stencilscope_instance")];
    let mut function = Function { name: entry.name.clone(), arguments, result: Some(result), ..Function::default() };
    let mut code = Code { expressions: &mut function.expressions, body: Block::new() };
    let given: Vec<Handle<Expression>> =
        (0..function.arguments.len() as u32).map(|index| code.plain(Expression::FunctionArgument(index))).collect();
    let made = code.plain(Expression::CallResult(inner));
    let arguments = given[..entry.arguments.len()].to_vec();
    code.push(Statement::Call { function: inner, arguments, result: Some(made) });
    let position = match position {
        Place::Whole(_) => made,
        Place::Member(_, index) => code.emitted(Expression::AccessIndex { base: made, index }),
    };
    let [vertex, instance] = numbers.map(|place| match place {
        Place::Whole(index) => given[index as usize],
        Place::Member(base, index) => code.emitted(Expression::AccessIndex { base: given[base as usize], index }),
    });
    code.push(Statement::Call { function: note, arguments: vec![position, vertex, instance], result: None });
    code.push(Statement::Return { value: Some(made) });
    function.body = code.body;
    Some(function)
}

/// What a fragment shader may do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fragment {
    pub discards: bool,
    pub writes_depth: bool,
}

/// What the fragment entry point of that name, or the only one, may do; `None` where there is no such.
pub fn fragment(module: &Module, name: Option<&str>) -> Option<Fragment> {
    let is_meant =
        |entry: &&EntryPoint| entry.stage == ShaderStage::Fragment && name.is_none_or(|name| entry.name == name);
    let entry = module.entry_points.iter().find(is_meant)?;
    let result = entry.function.result.as_ref();
    let depth = result.and_then(|result| place(module, 0, result.ty, result.binding.as_ref(), BuiltIn::FragDepth));
    let mut seen = BTreeSet::new();
    Some(Fragment { discards: kills(module, &entry.function.body, &mut seen), writes_depth: depth.is_some() })
}

/// Does a fragment's life end in a block, or in what it calls?
fn kills(module: &Module, block: &Block, seen: &mut BTreeSet<Handle<Function>>) -> bool {
    block.iter().any(|statement| match statement {
        Statement::Kill => true,
        Statement::Block(block) => kills(module, block, seen),
        Statement::If { accept, reject, .. } => kills(module, accept, seen) || kills(module, reject, seen),
        Statement::Switch { cases, .. } => cases.iter().any(|case| kills(module, &case.body, seen)),
        Statement::Loop { body, continuing, .. } => kills(module, body, seen) || kills(module, continuing, seen),
        Statement::Call { function, .. } => {
            seen.insert(*function) && kills(module, &module.functions[*function].body, seen)
        }
        _ => false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHADER: &str = "
        @group(0) @binding(0) var<uniform> used: vec4<f32>;
        @group(0) @binding(1) var<uniform> unused: vec4<f32>;
        @group(1) @binding(0) var<storage, read_write> counter: atomic<u32>;

        struct Out { @location(0) color: vec4<f32>, @builtin(position) position: vec4<f32> }
        @vertex fn structured(@builtin(instance_index) instance: u32) -> Out { return Out(used, used * f32(instance)); }
        @vertex fn plain() -> @invariant @builtin(position) vec4<f32> { return used; }
        @vertex fn counts() -> @builtin(position) vec4<f32> { atomicAdd(&counter, 1u); return used; }

        fn drops(x: f32) { if x > 1.0 { loop { discard; } } }
        @fragment fn keeps() -> @location(0) vec4<f32> { return used; }
        @fragment fn may_drop() -> @location(0) vec4<f32> { drops(used.x); return used; }
        @fragment fn deep() -> @builtin(frag_depth) f32 { return used.x; }
    ";

    fn module() -> Module {
        naga::front::wgsl::parse_str(SHADER).expect("a module")
    }

    /// What comes out is valid, binds what the entry point reads and no more, and has the log in its group.
    #[test]
    fn positions_are_noted_wherever_the_result_has_them() {
        for name in ["structured", "plain"] {
            let Logging { module, entry_point, bindings } = vertex_log(&module(), Some(name), 2).expect("rewritten");
            assert_eq!((entry_point.as_str(), bindings), (name, BTreeSet::from([(0, 0)])));
            assert_eq!(module.entry_points.len(), 1);
            let log = module.global_variables.iter().find(|(_, of)| of.binding.is_some_and(|of| of.group == 2));
            assert!(log.is_some());
            validated(&module).expect("valid");
        }
    }

    #[test]
    fn what_must_not_run_twice_is_named() {
        let refused = |name| vertex_log(&module(), Some(name), 2).map(drop);
        assert_eq!(refused("counts"), Err("its vertex shader writes to storage, and must not run twice"));
        assert_eq!(refused("nobody"), Err("its shader has no such vertex entry point"));
        // A fragment entry point is no vertex entry point.
        assert_eq!(refused("keeps"), Err("its shader has no such vertex entry point"));
    }

    #[test]
    fn a_discard_is_found_in_what_a_shader_calls() {
        let found = |name| fragment(&module(), Some(name));
        assert_eq!(found("keeps"), Some(Fragment { discards: false, writes_depth: false }));
        assert_eq!(found("may_drop"), Some(Fragment { discards: true, writes_depth: false }));
        assert_eq!(found("deep"), Some(Fragment { discards: false, writes_depth: true }));
        assert_eq!(found("nobody"), None);
    }
}
