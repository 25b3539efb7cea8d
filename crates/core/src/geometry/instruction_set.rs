//! Instruction sets: hot loops are compiled for more than one, and the processor at hand decides which runs.
//!
//! The program is built for plain x86-64, which cannot count bits in one instruction and has registers of 128 bits. A
//! [`Kernel`] is compiled a second time for x86-64-v3 (popcnt, AVX2), which processors have had since 2013. Both give the
//! same bits: integers are exact, and the compiler neither reorders nor fuses operations on floats, however wide the
//! registers are. Everywhere but on x86-64 there is one path, for the target as it is.
//!
//! Calling code for instructions that may be missing takes `unsafe`, which is the crate `pulp`'s.

use pulp::{Arch, Simd, WithSimd};

/// A loop that is worth compiling for each instruction set.
///
/// `run` must be `#[inline(always)]`, and so must be what it calls in its loop: code that is not inlined into it is
/// compiled for the plain target.
pub(crate) trait Kernel {
    /// The result.
    type Output;

    /// Runs it. `POPCNT` says whether the instruction set counts the bits of a word at once.
    fn run<const POPCNT: bool>(self) -> Self::Output;
}

/// Runs a kernel on the best instruction set that the processor has.
#[inline]
pub(crate) fn dispatch<K: Kernel>(kernel: K) -> K::Output {
    #[cfg(test)]
    if portable::is_forced() {
        return pulp::Scalar::new().vectorize(Compiled(kernel));
    }
    Arch::new().dispatch(Compiled(kernel))
}

/// A kernel as `pulp` compiles it.
struct Compiled<K>(K);

impl<K: Kernel> WithSimd for Compiled<K> {
    type Output = K::Output;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> K::Output {
        if S::IS_SCALAR && !cfg!(target_feature = "popcnt") {
            self.0.run::<false>()
        } else {
            self.0.run::<true>()
        }
    }
}

/// The portable path, for tests that compare it with the one the processor gets.
#[cfg(test)]
pub(crate) mod portable {
    use std::cell::Cell;

    thread_local! {
        static FORCED: Cell<bool> = const { Cell::new(false) };
    }

    /// Whether this thread's kernels run for the plain target.
    pub(super) fn is_forced() -> bool {
        FORCED.get()
    }

    /// Runs something with its kernels compiled for the plain target.
    pub(crate) fn portably<R>(run: impl FnOnce() -> R) -> R {
        FORCED.set(true);
        let result = run();
        FORCED.set(false);
        result
    }
}
