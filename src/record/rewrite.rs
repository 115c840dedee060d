//! Shaders that log where their vertices land, and which fragments they do not discard: the entry point becomes a
//! function that a new one calls.
//!
//! ```text
//! fn vs(…same inputs…, vertex, instance) -> …same outputs… {
//!     let result = inner(…);
//!     note(result.position, vertex, instance);
//!     return result;
//! }
//!
//! fn fs(…same inputs…, position, primitive) {
//!     inner(…);                  // where it discards, it sets a flag before: some GPUs go on from there
//!     if !discarded { note(pixel of position, first triangle + primitive); }
//! }
//! ```

use naga::{
    AddressSpace, Arena, AtomicFunction, BinaryOperator, Binding, Block, BuiltIn, EntryPoint, Expression, Function,
    FunctionArgument, GlobalVariable, Handle, Literal, Module, ResourceBinding, Scalar, ShaderStage, Span, Statement,
    StorageAccess, StructMember, Type, TypeInner, VectorSize,
};
use std::collections::BTreeSet;

/// Bytes at the start of a log, before its records: the count of records, padded.
pub const HEAD: u64 = 16;
/// Bytes of a record of a vertex: a position, the vertex, the instance, padding.
pub const RECORD: u64 = 32;
/// Bytes of a record of a fragment: column and row of its pixel in one word, its triangle.
pub const FRAGMENT_RECORD: u64 = 8;

/// A shader module with one entry point, rewritten so that it also writes a log.
#[derive(Debug)]
pub struct LoggingModule {
    pub module: Module,
    pub entry_point: String,
    /// Group and binding of the resources that the entry point reads.
    pub bindings: BTreeSet<(u32, u32)>,
}

/// Rewrites a module's vertex entry point of that name, or the first one, so that it also logs position, vertex and
/// instance to binding 0 of `group`. Other entry points are removed.
///
/// # Errors
/// Why it can't be rewritten.
pub fn vertex_log(module: &Module, name: Option<&str>, group: u32) -> Result<LoggingModule, &'static str> {
    let entry = entry_of(module, ShaderStage::Vertex, name).ok_or("its shader has no such vertex entry point")?;
    let before = used(module, entry)?;
    if before.writes {
        return Err("its vertex shader writes to storage, and must not run twice");
    }
    let rewritten = logging(module, entry, before, |module, function| {
        let scalar = TypeInner::Scalar(Scalar::U32);
        let position = TypeInner::Vector { size: VectorSize::Quad, scalar: Scalar::F32 };
        let fields = [("position", position, 0), ("vertex", scalar.clone(), 16), ("instance", scalar, 20)];
        let note = note(module, group, &fields, RECORD as u32);
        noting_vertices(module, function, note)
    });
    rewritten.ok_or("its vertex shader can't be rewritten")
}

/// Returns group and binding of the resources that a module's vertex entry point of that name, or the first one, uses.
///
/// # Errors
/// It must not run twice.
pub fn vertex_bindings(module: &Module, name: Option<&str>) -> Result<BTreeSet<(u32, u32)>, &'static str> {
    let entry = entry_of(module, ShaderStage::Vertex, name).ok_or("its shader has no such vertex entry point")?;
    let used = used(module, entry)?;
    if used.writes { Err("its vertex shader writes to storage, and must not run twice") } else { Ok(used.bindings) }
}

/// Rewrites the fragment entry point of that name, or the only one, with a log as binding 0 and the number of the first
/// triangle as binding 1 of a group of its own. It has no outputs.
///
/// # Errors
/// Why it can't be rewritten.
pub fn fragment_log(module: &Module, name: Option<&str>, group: u32) -> Result<LoggingModule, &'static str> {
    let entry = entry_of(module, ShaderStage::Fragment, name).ok_or("its shader has no such fragment entry point")?;
    let before = used(module, entry)?;
    if before.writes {
        return Err("its fragment shader writes to storage, and must not run twice");
    }
    let rewritten = logging(module, entry, before, |module, function| {
        let scalar = TypeInner::Scalar(Scalar::U32);
        let fields = [("pixel", scalar.clone(), 0), ("triangle", scalar, 4)];
        let note = note(module, group, &fields, FRAGMENT_RECORD as u32);
        Some(noting_fragments(module, function, note, group))
    });
    rewritten.ok_or("its fragment shader can't be rewritten")
}

/// Returns the entry point of a stage with that name, or the first of the stage where `name` is `None`; `None` where
/// there is none.
fn entry_of<'a>(module: &'a Module, stage: ShaderStage, name: Option<&str>) -> Option<&'a EntryPoint> {
    module.entry_points.iter().find(|entry| entry.stage == stage && name.is_none_or(|name| entry.name == name))
}

/// Returns a copy of a module whose only entry point is `entry` with the function that `rewrite` derives from its own;
/// `None` where that fails or the result is not valid.
fn logging(
    module: &Module,
    entry: &EntryPoint,
    before: UsedBindings,
    rewrite: impl FnOnce(&mut Module, &Function) -> Option<Function>,
) -> Option<LoggingModule> {
    let (mut module, mut entry) = (module.clone(), entry.clone());
    module.entry_points.clear();
    entry.function = rewrite(&mut module, &entry.function)?;
    let entry_point = entry.name.clone();
    module.entry_points.push(entry);
    validated(&module).ok()?;
    Some(LoggingModule { module, entry_point, bindings: before.bindings })
}

fn validated(module: &Module) -> Result<naga::valid::ModuleInfo, Box<naga::WithSpan<naga::valid::ValidationError>>> {
    let (flags, capabilities) = (naga::valid::ValidationFlags::all(), naga::valid::Capabilities::all());
    naga::valid::Validator::new(flags, capabilities).validate(module).map_err(Box::new)
}

struct UsedBindings {
    bindings: BTreeSet<(u32, u32)>,
    writes: bool,
}

/// Returns the bindings that an entry point uses, and whether it writes to any of them. Fails where the module is not
/// valid.
fn used(module: &Module, entry: &EntryPoint) -> Result<UsedBindings, &'static str> {
    let info = validated(module).map_err(|_| "its shader is not valid")?;
    let index = module.entry_points.iter().position(|one| one.name == entry.name && one.stage == entry.stage);
    let info = info.get_entry_point(index.ok_or("its shader has no such entry point")?);
    let mut used = UsedBindings { bindings: BTreeSet::new(), writes: false };
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

/// Adds to the module a function with these fields (name, type, offset in the record) as arguments: it appends them as
/// a record to the log at binding 0 of `group`, and counts on without storing where the log is full.
fn note(module: &mut Module, group: u32, fields: &[(&str, TypeInner, u32)], record_bytes: u32) -> Handle<Function> {
    let unsigned = add_type(module, TypeInner::Scalar(Scalar::U32));
    let counter = add_type(module, TypeInner::Atomic(Scalar::U32));
    let mut arguments = Vec::new();
    let mut members = Vec::new();
    for (name, inner, offset) in fields {
        let ty = add_type(module, inner.clone());
        arguments.push(FunctionArgument { name: Some((*name).to_owned()), ty, binding: None });
        members.push(member(name, ty, *offset));
    }
    let record =
        Type { name: Some("StencilscopeRecord".into()), inner: TypeInner::Struct { members, span: record_bytes } };
    let record = module.types.insert(record, Span::UNDEFINED);
    let records = TypeInner::Array { base: record, size: naga::ArraySize::Dynamic, stride: record_bytes };
    let records = add_type(module, records);
    let members = vec![member("count", counter, 0), member("records", records, HEAD as u32)];
    let span = HEAD as u32 + record_bytes;
    let log = Type { name: Some("StencilscopeLog".into()), inner: TypeInner::Struct { members, span } };
    let log = module.types.insert(log, Span::UNDEFINED);
    let access = StorageAccess::LOAD | StorageAccess::STORE;
    let variable = global(module, "stencilscope_log", access, [group, 0], log);
    let mut function = Function { name: Some("stencilscope_note".into()), arguments, ..Function::default() };
    let mut code = FunctionCode { expressions: &mut function.expressions, body: Block::new() };
    let components = (0..fields.len() as u32).map(|index| code.plain(Expression::FunctionArgument(index))).collect();
    let log = code.plain(Expression::GlobalVariable(variable));
    let one = code.plain(Expression::Literal(Literal::U32(1)));
    let count = code.emitted(Expression::AccessIndex { base: log, index: 0 });
    let at = code.plain(Expression::AtomicResult { ty: unsigned, comparison: false });
    code.push(Statement::Atomic { pointer: count, fun: AtomicFunction::Add, value: one, result: Some(at) });
    let records = code.emitted(Expression::AccessIndex { base: log, index: 1 });
    let capacity = code.emitted(Expression::ArrayLength(records));
    let fits = code.emitted(Expression::Binary { op: BinaryOperator::Less, left: at, right: capacity });
    let outer = std::mem::replace(&mut code.body, Block::new());
    let pointer = code.emitted(Expression::Access { base: records, index: at });
    let value = code.emitted(Expression::Compose { ty: record, components });
    code.push(Statement::Store { pointer, value });
    let accept = std::mem::replace(&mut code.body, outer);
    code.push(Statement::If { condition: fits, accept, reject: Block::new() });
    code.push(Statement::Return { value: None });
    function.body = code.body;
    module.functions.append(function, Span::UNDEFINED)
}

/// Appends a storage-buffer variable with this access, group and binding to a shader module.
fn global(
    module: &mut Module,
    name: &str,
    access: StorageAccess,
    [group, binding]: [u32; 2],
    ty: Handle<Type>,
) -> Handle<GlobalVariable> {
    let variable = GlobalVariable {
        name: Some(name.to_owned()),
        space: AddressSpace::Storage { access },
        binding: Some(ResourceBinding { group, binding }),
        ty,
        init: None,
        memory_decorations: naga::MemoryDecorations::empty(),
    };
    module.global_variables.append(variable, Span::UNDEFINED)
}

/// Builds the statements and expressions of a function of a shader module.
struct FunctionCode<'a> {
    expressions: &'a mut Arena<Expression>,
    body: Block,
}

impl FunctionCode<'_> {
    /// Appends an expression that needs no evaluation, such as a constant, to the function.
    fn plain(&mut self, expression: Expression) -> Handle<Expression> {
        self.expressions.append(expression, Span::UNDEFINED)
    }

    /// Appends an expression to the function, and to the end of its body the statement that evaluates it. Only for
    /// expressions that are evaluated: arguments, constants and the like use [`FunctionCode::plain`].
    fn emitted(&mut self, expression: Expression) -> Handle<Expression> {
        let before = self.expressions.len();
        let handle = self.plain(expression);
        let range = self.expressions.range_from(before);
        self.push(Statement::Emit(range));
        handle
    }

    /// Adds `count` expressions for the function's arguments and returns their handles.
    fn arguments(&mut self, count: usize) -> Vec<Handle<Expression>> {
        (0..count as u32).map(|index| self.plain(Expression::FunctionArgument(index))).collect()
    }

    /// Returns the argument that `place` names, or its member, which is read here.
    fn given(&mut self, arguments: &[Handle<Expression>], place: BuiltinPlace) -> Handle<Expression> {
        match place {
            BuiltinPlace::Whole(index) => arguments[index as usize],
            BuiltinPlace::Member(base, index) => {
                self.emitted(Expression::AccessIndex { base: arguments[base as usize], index })
            }
        }
    }

    fn push(&mut self, statement: Statement) {
        self.body.push(statement, Span::UNDEFINED);
    }
}

/// Where an entry point has a built-in value: an argument or result of its own, or a member of one.
enum BuiltinPlace {
    Whole(u32),
    Member(u32, u32),
}

fn place(
    module: &Module,
    index: u32,
    ty: Handle<Type>,
    binding: Option<&Binding>,
    wanted: BuiltIn,
) -> Option<BuiltinPlace> {
    let is_wanted = |binding: Option<&Binding>| matches!(binding, Some(Binding::BuiltIn(of)) if is_same(*of, wanted));
    if is_wanted(binding) {
        return Some(BuiltinPlace::Whole(index));
    }
    let TypeInner::Struct { members, .. } = &module.types[ty].inner else { return None };
    let member = members.iter().position(|member| is_wanted(member.binding.as_ref()))?;
    Some(BuiltinPlace::Member(index, member as u32))
}

/// Compares built-ins; positions may be invariant, or not.
fn is_same(built_in: BuiltIn, wanted: BuiltIn) -> bool {
    std::mem::discriminant(&built_in) == std::mem::discriminant(&wanted)
}

/// Appends to the module a copy of an entry point's function that another can call: its arguments and result have no
/// bindings.
fn inner(module: &mut Module, entry: &Function) -> Handle<Function> {
    let mut inner = entry.clone();
    inner.name = Some("stencilscope_inner".into());
    inner.arguments.iter_mut().for_each(|argument| argument.binding = None);
    inner.result.iter_mut().for_each(|result| result.binding = None);
    module.functions.append(inner, Span::UNDEFINED)
}

/// Returns where the built-in value `wanted` is among the arguments, or a member of one; appends an argument with this
/// name and type where it is not yet.
fn input(
    module: &mut Module,
    arguments: &mut Vec<FunctionArgument>,
    wanted: BuiltIn,
    name: &str,
    inner: TypeInner,
) -> BuiltinPlace {
    let found = (0..)
        .zip(&*arguments)
        .find_map(|(index, argument)| place(module, index, argument.ty, argument.binding.as_ref(), wanted));
    found.unwrap_or_else(|| {
        let (name, ty) = (Some(name.to_owned()), add_type(module, inner));
        arguments.push(FunctionArgument { name, ty, binding: Some(Binding::BuiltIn(wanted)) });
        BuiltinPlace::Whole(arguments.len() as u32 - 1)
    })
}

/// Returns a function to replace a vertex entry point's: it calls the original, logs position, vertex and instance, and
/// returns the original's result. `None` where the result has no position.
fn noting_vertices(module: &mut Module, entry: &Function, note: Handle<Function>) -> Option<Function> {
    let result = entry.result.clone()?;
    let position = place(module, 0, result.ty, result.binding.as_ref(), BuiltIn::Position { invariant: false })?;
    let inner = inner(module, entry);
    let mut arguments = entry.arguments.clone();
    let numbers = [(BuiltIn::VertexIndex, "stencilscope_vertex"), (BuiltIn::InstanceIndex, "stencilscope_instance")];
    let numbers =
        numbers.map(|(wanted, name)| input(module, &mut arguments, wanted, name, TypeInner::Scalar(Scalar::U32)));
    let mut function = Function { name: entry.name.clone(), arguments, result: Some(result), ..Function::default() };
    let mut code = FunctionCode { expressions: &mut function.expressions, body: Block::new() };
    let given = code.arguments(function.arguments.len());
    let made = code.plain(Expression::CallResult(inner));
    let arguments = given[..entry.arguments.len()].to_vec();
    code.push(Statement::Call { function: inner, arguments, result: Some(made) });
    let position = match position {
        BuiltinPlace::Whole(_) => made,
        BuiltinPlace::Member(_, index) => code.emitted(Expression::AccessIndex { base: made, index }),
    };
    let [vertex, instance] = numbers.map(|place| code.given(&given, place));
    code.push(Statement::Call { function: note, arguments: vec![position, vertex, instance], result: None });
    code.push(Statement::Return { value: Some(made) });
    function.body = code.body;
    Some(function)
}

/// Adds a private boolean variable to the module that is set before each discard, in all of its functions and in
/// `entry`; returns the variable.
fn flag_discards(module: &mut Module, entry: &mut Function) -> Handle<GlobalVariable> {
    let ty = add_type(module, TypeInner::Scalar(Scalar::BOOL));
    let variable = GlobalVariable {
        name: Some("stencilscope_discarded".into()),
        space: AddressSpace::Private,
        binding: None,
        ty,
        init: None,
        memory_decorations: naga::MemoryDecorations::empty(),
    };
    let flag = module.global_variables.append(variable, Span::UNDEFINED);
    for function in module.functions.iter_mut().map(|(_, function)| function).chain([entry]) {
        let pointer = function.expressions.append(Expression::GlobalVariable(flag), Span::UNDEFINED);
        let value = function.expressions.append(Expression::Literal(Literal::Bool(true)), Span::UNDEFINED);
        before_kills(&mut function.body, &Statement::Store { pointer, value });
    }
    flag
}

/// Inserts a statement before each discard of a block and of the blocks within it.
fn before_kills(block: &mut Block, statement: &Statement) {
    let mut changed = Block::with_capacity(block.len());
    for (mut one, span) in std::mem::take(block).span_into_iter() {
        match &mut one {
            Statement::Kill => changed.push(statement.clone(), span),
            Statement::Block(inner) => before_kills(inner, statement),
            Statement::If { accept, reject, .. } => {
                [accept, reject].into_iter().for_each(|inner| before_kills(inner, statement));
            }
            Statement::Switch { cases, .. } => {
                cases.iter_mut().for_each(|case| before_kills(&mut case.body, statement));
            }
            Statement::Loop { body, continuing, .. } => {
                [body, continuing].into_iter().for_each(|inner| before_kills(inner, statement));
            }
            _ => {}
        }
        changed.push(one, span);
    }
    *block = changed;
}

/// Returns a function to replace a fragment entry point's: it calls the original and, where that did not discard, logs
/// the pixel and the triangle. The module's functions are changed too, so that they flag discards.
fn noting_fragments(module: &mut Module, entry: &Function, note: Handle<Function>, group: u32) -> Function {
    let mut entry = entry.clone();
    let discarded = flag_discards(module, &mut entry);
    let entry = &entry;
    let inner = inner(module, entry);
    let mut arguments = entry.arguments.clone();
    let position = TypeInner::Vector { size: VectorSize::Quad, scalar: Scalar::F32 };
    let at = BuiltIn::Position { invariant: false };
    let at = input(module, &mut arguments, at, "stencilscope_at", position);
    let scalar = TypeInner::Scalar(Scalar::U32);
    let primitive = input(module, &mut arguments, BuiltIn::PrimitiveIndex, "stencilscope_primitive", scalar.clone());
    let unsigned = add_type(module, scalar);
    let members = vec![member("triangle", unsigned, 0)];
    let first = Type { name: Some("StencilscopeFirst".into()), inner: TypeInner::Struct { members, span: 4 } };
    let first = module.types.insert(first, Span::UNDEFINED);
    let first = global(module, "stencilscope_first", StorageAccess::LOAD, [group, 1], first);
    let mut function = Function { name: entry.name.clone(), arguments, ..Function::default() };
    let mut code = FunctionCode { expressions: &mut function.expressions, body: Block::new() };
    // Nothing else sets it at a fragment's begin: some drivers leave what the fragment before has left.
    let pointer = code.plain(Expression::GlobalVariable(discarded));
    let value = code.plain(Expression::Literal(Literal::Bool(false)));
    code.push(Statement::Store { pointer, value });
    let given = code.arguments(function.arguments.len());
    let made = entry.result.as_ref().map(|_| code.plain(Expression::CallResult(inner)));
    let arguments = given[..entry.arguments.len()].to_vec();
    code.push(Statement::Call { function: inner, arguments, result: made });
    let at = code.given(&given, at);
    let [column, row] = [0, 1].map(|axis| {
        let side = code.emitted(Expression::AccessIndex { base: at, index: axis });
        code.emitted(Expression::As { expr: side, kind: naga::ScalarKind::Uint, convert: Some(4) })
    });
    let sixteen = code.plain(Expression::Literal(Literal::U32(16)));
    let row = code.emitted(Expression::Binary { op: BinaryOperator::ShiftLeft, left: row, right: sixteen });
    let pixel = code.emitted(Expression::Binary { op: BinaryOperator::InclusiveOr, left: column, right: row });
    let first = code.plain(Expression::GlobalVariable(first));
    let first = code.emitted(Expression::AccessIndex { base: first, index: 0 });
    let first = code.emitted(Expression::Load { pointer: first });
    let primitive = code.given(&given, primitive);
    let triangle = code.emitted(Expression::Binary { op: BinaryOperator::Add, left: first, right: primitive });
    let discarded = code.plain(Expression::GlobalVariable(discarded));
    let discarded = code.emitted(Expression::Load { pointer: discarded });
    let outer = std::mem::replace(&mut code.body, Block::new());
    code.push(Statement::Call { function: note, arguments: vec![pixel, triangle], result: None });
    let reject = std::mem::replace(&mut code.body, outer);
    code.push(Statement::If { condition: discarded, accept: Block::new(), reject });
    code.push(Statement::Return { value: None });
    function.body = code.body;
    function
}

/// Whether a fragment shader may discard fragments, write the sample mask, or write depth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FragmentEffects {
    pub discards: bool,
    /// True where it writes the sample mask.
    pub masks: bool,
    pub writes_depth: bool,
}

/// Returns whether the vertex entry point of that name, or the first one, writes clip distances; false where there is
/// no such entry point.
pub fn clips(module: &Module, name: Option<&str>) -> bool {
    let entry = entry_of(module, ShaderStage::Vertex, name);
    entry.is_some_and(|entry| output(module, entry, BuiltIn::ClipDistances).is_some())
}

fn output(module: &Module, entry: &EntryPoint, wanted: BuiltIn) -> Option<BuiltinPlace> {
    let result = entry.function.result.as_ref()?;
    place(module, 0, result.ty, result.binding.as_ref(), wanted)
}

/// Returns whether the fragment entry point of that name, or the first one, discards, writes a sample mask or writes
/// depth; `None` where there is no such entry point.
pub fn fragment(module: &Module, name: Option<&str>) -> Option<FragmentEffects> {
    let entry = entry_of(module, ShaderStage::Fragment, name)?;
    let has = |wanted| output(module, entry, wanted).is_some();
    let discards = kills(module, &entry.function.body, &mut BTreeSet::new());
    Some(FragmentEffects { discards, masks: has(BuiltIn::SampleMask), writes_depth: has(BuiltIn::FragDepth) })
}

/// Returns whether a block, or a function that it calls, contains a discard. Functions in `seen` are not looked into
/// again, and those that are get added to it.
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
        struct In { @location(0) @interpolate(flat) x: u32, @builtin(position) at: vec4<f32> }
        @fragment fn knows(in: In, @builtin(front_facing) front: bool) { if front { drops(in.at.x * used.x); } }
        @fragment fn masked() -> @builtin(sample_mask) u32 { return 0u; }
        @fragment fn counts_too() { atomicAdd(&counter, 1u); }
    ";

    fn module() -> Module {
        naga::front::wgsl::parse_str(SHADER).expect("a module")
    }

    /// The result is valid, binds what the entry point reads and no more, and has the log in its group.
    #[test]
    fn positions_are_noted_wherever_the_result_has_them() {
        for name in ["structured", "plain"] {
            let LoggingModule { module, entry_point, bindings } =
                vertex_log(&module(), Some(name), 2).expect("rewritten");
            assert_eq!((entry_point.as_str(), bindings), (name, BTreeSet::from([(0, 0)])));
            assert_eq!(module.entry_points.len(), 1);
            let log = module.global_variables.iter().find(|(_, of)| of.binding.is_some_and(|of| of.group == 2));
            assert!(log.is_some());
            validated(&module).expect("valid");
        }
    }

    /// Whatever its outputs are, and whether or not it reads its position.
    #[test]
    fn kept_fragments_are_noted() {
        for name in ["keeps", "may_drop", "deep", "knows"] {
            let LoggingModule { module, bindings, .. } = fragment_log(&module(), Some(name), 2).expect("rewritten");
            assert_eq!(bindings, BTreeSet::from([(0, 0)]));
            assert!(module.entry_points[0].function.result.is_none());
            validated(&module).expect("valid");
        }
        let refused = fragment_log(&module(), Some("counts_too"), 2).map(drop);
        assert_eq!(refused, Err("its fragment shader writes to storage, and must not run twice"));
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
        assert_eq!(found("keeps"), Some(FragmentEffects { discards: false, masks: false, writes_depth: false }));
        assert_eq!(found("may_drop"), Some(FragmentEffects { discards: true, masks: false, writes_depth: false }));
        assert_eq!(found("deep"), Some(FragmentEffects { discards: false, masks: false, writes_depth: true }));
        assert_eq!(found("masked"), Some(FragmentEffects { discards: false, masks: true, writes_depth: false }));
        assert_eq!(found("nobody"), None);
    }
}
