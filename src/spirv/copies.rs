//! How often each function's code stands in a kernel once a driver has inlined all calls.

use std::collections::HashMap;

use super::live::Live;
use super::module::{HEADER, Module};
use super::op;
use super::propagate::Propagation;

/// One function of a specialised kernel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Copies {
    /// Its name in GLSL.
    pub name: String,
    /// Its own instructions.
    pub instructions: usize,
    /// The places that it is inlined at.
    pub copies: usize,
}

/// Every function that is left of a kernel with these values of its specialisation constants, the heaviest (instructions x copies) first. The
/// module must have its names.
pub fn copies(words: &[u32], constants: &[(u32, u32)]) -> Result<Vec<Copies>, String> {
    let module = Module::parse(words)?;
    let found = Propagation::run(&module, constants)?;
    let live = Live::find(&found);
    let names = function_names(words);
    let mut all = Vec::new();
    let mut calls: Vec<Vec<usize>> = Vec::new();
    for function in &found.functions {
        let blocks = function.blocks.clone().filter(|block| found.reached[*block as usize]);
        let code = blocks.flat_map(|block| found.blocks[block as usize].first..=found.blocks[block as usize].last);
        let mut called = Vec::new();
        let mut instructions = 0;
        for index in code {
            let instruction = module.code[index as usize];
            let stays =
                live.instructions[index as usize] || instruction.op == op::LABEL || op::is_terminator(instruction.op);
            instructions += usize::from(stays);
            if instruction.op == op::FUNCTION_CALL && live.instructions[index as usize] {
                called.extend(found.function_of(module.operands(instruction)[0]));
            }
        }
        let id = module.result(module.code[function.first as usize]).unwrap_or_default();
        all.push(Copies { name: names.get(&id).cloned().unwrap_or_default(), instructions, copies: 0 });
        calls.push(called);
    }
    // SPIR-V has no recursion: a caller's copies are final once those of all that call it are.
    let mut callers = vec![0usize; all.len()];
    let kept: Vec<usize> = (0..all.len()).filter(|function| live.functions[*function]).collect();
    kept.iter().flat_map(|function| &calls[*function]).for_each(|callee| callers[*callee] += 1);
    let mut ready: Vec<usize> = kept.into_iter().filter(|function| callers[*function] == 0).collect();
    ready.iter().for_each(|function| all[*function].copies = 1);
    while let Some(function) = ready.pop() {
        for callee in &calls[function] {
            all[*callee].copies += all[function].copies;
            callers[*callee] -= 1;
            if callers[*callee] == 0 {
                ready.push(*callee);
            }
        }
    }
    all.retain(|function| function.copies > 0);
    all.sort_by_key(|function| std::cmp::Reverse(function.instructions * function.copies));
    Ok(all)
}

/// The names of functions, without their parameters.
fn function_names(words: &[u32]) -> HashMap<u32, String> {
    let mut names = HashMap::new();
    let mut at = HEADER;
    while at < words.len() {
        let (number, length) = ((words[at] & 0xffff) as u16, (words[at] >> 16) as usize);
        if number == op::NAME && length > 2 {
            let bytes = words[at + 2..at + length].iter().flat_map(|word| word.to_le_bytes());
            let name: Vec<u8> = bytes.take_while(|byte| !matches!(byte, 0 | b'(')).collect();
            names.insert(words[at + 1], String::from_utf8_lossy(&name).into_owned());
        }
        at += length.max(1);
    }
    names
}
