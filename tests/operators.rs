//! What WGSL forbids and naga lets through: kernels are held to it here, for browsers refuse them otherwise.
//! `./web.sh --test` asks a browser itself.

use naga::back::pipeline_constants::process_overrides;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{BinaryOperator, Expression, Function, Literal, MathFunction, Module, ShaderStage};
use subpixel_shadows::gpu::kernels;

/// A token: words and numbers as one, operators whole.
fn tokens(text: &str) -> Vec<(usize, String)> {
    const LONG: [&str; 20] = [
        "<<=", ">>=", "&&", "||", "<<", ">>", "==", "!=", "<=", ">=", "->", "++", "--", "+=", "-=", "*=", "/=", "%=",
        "&=", "|=",
    ];
    let mut out = Vec::new();
    for (k, line) in text.lines().enumerate() {
        let mut rest = line.split("//").next().unwrap_or("").trim_start();
        while !rest.is_empty() {
            let word = rest.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == '.')).unwrap_or(rest.len());
            let long = LONG.iter().find(|op| rest.starts_with(**op)).map(|op| op.len());
            let length = if word > 0 { word } else { long.unwrap_or(1) };
            out.push((k + 1, rest[..length].to_owned()));
            rest = &rest[length..];
            // A list of template arguments: no operator is in it.
            let name = &out[out.len() - 1].1;
            let takes = ["vec", "mat", "array", "ptr", "atomic", "bitcast", "var", "texture"];
            if word > 0 && rest.starts_with('<') && takes.iter().any(|t| name.starts_with(t)) && !rest.starts_with("<<")
            {
                let mut depth = 0;
                let end = rest.find(|c| {
                    depth += i32::from(c == '<') - i32::from(c == '>');
                    depth == 0
                });
                rest = &rest[end.map_or(rest.len(), |end| end + 1)..];
            }
            rest = rest.trim_start();
        }
    }
    out
}

/// Why these operators may not stand beside each other without parentheses, by the grammar of WGSL.
fn refused(operators: &[&str]) -> Option<String> {
    let any = |set: &[&str]| operators.iter().copied().find(|op| set.contains(op)).map(str::to_owned);
    let mixed = |a: &str, b: &str| Some(format!("mixing '{a}' and '{b}' requires parentheses"));
    if let Some(bits) = any(&["&", "|", "^"]) {
        return operators.iter().find(|op| **op != bits).and_then(|op| mixed(&bits, op));
    }
    if any(&["&&"]).is_some() && any(&["||"]).is_some() {
        return mixed("&&", "||");
    }
    let comparisons = ["==", "!=", "<", ">", "<=", ">="];
    for part in operators.split(|op| ["&&", "||"].contains(op)) {
        let between: Vec<_> = part.split(|op| comparisons.contains(op)).collect();
        if between.len() > 2 {
            return Some("two comparisons in a row".to_owned());
        }
        for side in between.into_iter().filter(|side| side.len() > 1) {
            if let Some(shift) = side.iter().find(|op| ["<<", ">>"].contains(op)) {
                return side.iter().find(|op| *op != shift).map_or(mixed(shift, shift), |op| mixed(shift, op));
            }
        }
    }
    None
}

/// Places of a text where operators stand beside each other that may not.
fn mixings(text: &str) -> Vec<String> {
    const BINARY: [&str; 18] =
        ["+", "-", "*", "/", "%", "&", "|", "^", "<<", ">>", "&&", "||", "==", "!=", "<", ">", "<=", ">="];
    let mut found = Vec::new();
    let mut levels: Vec<Vec<String>> = vec![Vec::new()];
    let mut operand = false; // what came last is a value
    for (line, token) in tokens(text) {
        let token = token.as_str();
        let mut close = |operators: &mut Vec<String>| {
            let operators: Vec<_> = std::mem::take(operators);
            let names: Vec<_> = operators.iter().map(String::as_str).collect();
            found.extend(refused(&names).map(|why| format!("line {line}: {why}")));
        };
        match token {
            "(" | "[" => (levels.push(Vec::new()), operand = false).1,
            ")" | "]" => {
                levels.pop().as_mut().map(&mut close);
                operand = true;
            }
            op if BINARY.contains(&op) => {
                let level = levels.last_mut().expect("brackets that match");
                level.extend(operand.then(|| op.to_owned()));
                operand = false;
            }
            "!" | "~" => operand = false,
            word if word.starts_with(|c: char| c.is_alphanumeric() || c == '_') => {
                operand =
                    !["return", "if", "else", "while", "for", "let", "var", "const", "switch", "case"].contains(&word);
            }
            _ => {
                // Commas, braces, assignments: another expression begins.
                levels.last_mut().map(&mut close);
                operand = false;
            }
        }
    }
    found
}

#[test]
fn operators_are_not_mixed() {
    let mut checked = 0;
    for (stem, source, _) in kernels::ALL {
        let source = &source.text();
        checked += tokens(source).iter().filter(|(_, t)| ["&", "|", "<<", ">>"].contains(&t.as_str())).count();
        let found = mixings(source);
        let text = |at: &str| source.lines().nth(at.parse::<usize>().unwrap_or(1) - 1).unwrap_or_default().to_owned();
        let line = |why: &String| text(why["line ".len()..].split(':').next().unwrap_or_default());
        assert!(found.is_empty(), "kernels/{stem}.wgsl: {} in `{}`", found[0], line(&found[0]));
    }
    assert!(checked > 1000, "{checked} operators");
}

/// The check finds what it must, the line that a browser refused among it, and lets through what is allowed.
#[test]
fn mixed_operators_are_found() {
    for bad in [
        "return (texels & 1u) * 0x33u | ((texels >> 1u) & 1u) * 0xccu;",
        "x = a & b == c;",
        "let y = f(a | b & c);",
        "let y = a << b + 1u;",
        "let y = a + b >> 1u;",
        "let y = a << b << c;",
        "if a && b || c { }",
        "if a < b == c { }",
        "let y = m[a ^ b + 1u];",
        "let y = 1u | -x * 3u;",
    ] {
        assert_eq!(mixings(bad).len(), 1, "{bad}");
    }
    for good in [
        "let y = (a & b) | (c & ~d);",
        "let y = a & b & c; x |= 1u << k;",
        "if (a & b) != 0u && x + 1u < y * 2u { }",
        "let y = bitcast<u32>(max(depth, 0.0)) >> 16u;",
        "let v = vec2<u32>(a, b) + array<u32, 3>(a + b, c << 1u, -d)[0];",
        "for (var k = 0u; k < n << 1u; k++) { a[k] = -b[k] - !c; }",
        "if a || b || c < d { }",
    ] {
        assert_eq!(mixings(good), Vec::<String>::new(), "{good}");
    }
}

/// What of a function's constant expressions has no value.
fn without_value(module: &Module, function: &Function) -> Vec<String> {
    let all = &function.expressions;
    let number = |handle| -> Option<f64> {
        let mut handle = handle;
        loop {
            match all[handle] {
                Expression::Literal(Literal::U32(v)) => return Some(v.into()),
                Expression::Literal(Literal::I32(v)) => return Some(v.into()),
                Expression::Literal(Literal::F32(v)) => return Some(v.into()),
                Expression::Constant(constant) => {
                    let init = module.constants[constant].init;
                    return match module.global_expressions[init] {
                        Expression::Literal(Literal::U32(v)) => Some(v.into()),
                        Expression::Literal(Literal::I32(v)) => Some(v.into()),
                        Expression::Literal(Literal::F32(v)) => Some(v.into()),
                        _ => None,
                    };
                }
                Expression::Splat { value, .. } => handle = value,
                _ => return None,
            }
        }
    };
    let mut found = Vec::new();
    for (_, expression) in all.iter() {
        match *expression {
            Expression::Math { fun: MathFunction::Clamp, arg1: Some(low), arg2: Some(high), .. } => {
                if let (Some(low), Some(high)) = (number(low), number(high))
                    && low > high
                {
                    found.push(format!("clamp between {low} and {high}"));
                }
            }
            Expression::Math { fun: MathFunction::SmoothStep, arg, arg1: Some(high), .. } => {
                if let (Some(low), Some(high)) = (number(arg), number(high))
                    && low >= high
                {
                    found.push(format!("smoothstep between {low} and {high}"));
                }
            }
            Expression::Math {
                fun: MathFunction::ExtractBits | MathFunction::InsertBits,
                arg1: Some(a),
                arg2: Some(b),
                ..
            } => {
                if let (Some(a), Some(b)) = (number(a), number(b))
                    && a + b > 32.0
                {
                    found.push(format!("bits from {a}, {b} of them"));
                }
            }
            Expression::Binary { op, right, .. } => match (op, number(right)) {
                (BinaryOperator::ShiftLeft | BinaryOperator::ShiftRight, Some(by)) if by >= 32.0 => {
                    found.push(format!("a shift by {by}"));
                }
                (BinaryOperator::Divide | BinaryOperator::Modulo, Some(0.0)) => {
                    found.push("a division by 0".to_owned())
                }
                _ => {}
            },
            Expression::Literal(Literal::F32(v)) if !v.is_finite() => found.push(format!("the number {v}")),
            _ => {}
        }
    }
    found
}

/// The same of an entry point and all functions, overrides at these values.
fn all_without_value(source: &str, entry: &str, values: &[(&str, f64)]) -> Vec<String> {
    let module = naga::front::wgsl::parse_str(source).unwrap_or_else(|e| panic!("{}", e.emit_to_string(source)));
    let allowed = Capabilities::SHADER_INT64 | Capabilities::SHADER_INT64_ATOMIC_ALL_OPS;
    let info = Validator::new(ValidationFlags::all(), allowed).validate(&module).expect("a sound kernel");
    let values = values.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    // naga looks at some of it itself.
    let (module, _) = match process_overrides(&module, &info, Some((ShaderStage::Compute, entry)), &values) {
        Ok(processed) => processed,
        Err(error) => return vec![error.to_string()],
    };
    let functions = module.functions.iter().map(|(_, f)| f).chain(module.entry_points.iter().map(|e| &e.function));
    functions.flat_map(|f| without_value(&module, f)).collect()
}

#[test]
fn constants_have_values() {
    // Those of 64 bits are no plain WGSL: no browser gets them.
    for (stem, source, entries) in kernels::ALL.iter().filter(|(stem, ..)| !stem.ends_with("_64")) {
        let source = &source.text();
        for entry in *entries {
            let found = all_without_value(source, entry.name, &[]);
            assert!(found.is_empty(), "kernels/{stem}.wgsl: {}: {found:?} with the defaults", entry.name);
        }
    }
}

#[test]
fn constants_without_a_value_are_found() {
    let kernel = |statement: &str| {
        let head = "override N: u32 = 0u; @group(0) @binding(0) var<storage, read_write> x: array<f32>;";
        format!("{head}\n@compute @workgroup_size(1) fn main() {{ let v = u32(x[0]); let w = i32(v); {statement} }}")
    };
    for (bad, at) in [
        ("x[0] = clamp(x[1], 0.0, f32(N) - 1.0);", 0.0),
        ("x[0] = f32(v << (N + 32u));", 0.0),
        ("x[0] = f32(v / N);", 0.0),
        ("x[0] = f32(v % (N - 2u));", 2.0),
        ("x[0] = f32(extractBits(v, 20u, N));", 13.0),
        ("x[0] = smoothstep(f32(N), 1.0, x[1]);", 1.0),
    ] {
        let found = all_without_value(&kernel(bad), "main", &[("N", at)]);
        assert_eq!(found.len(), 1, "{bad}: {found:?}");
        let sound = all_without_value(&kernel(bad), "main", &[("N", 12.0)]);
        let still = bad.contains("smoothstep") || bad.contains("+ 32u");
        assert_eq!(sound.len(), usize::from(still), "{bad}: {sound:?}");
    }
}
