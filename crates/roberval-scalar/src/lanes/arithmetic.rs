//! What all lanes made of one register have in common.
//!
//! Macros instead of closures and `map`: a closure that is not inlined is compiled without
//! the processor's features.

/// A lane type whose arithmetic is given by intrinsics.
macro_rules! arithmetic {
    ($name:ident, $raw:ty, $count:literal, $add:ident, $sub:ident, $mul:ident, $neg:ident,
     $fma:ident, $fnma:ident, $splat:ident) => {
        /// Floats side by side in one register.
        #[derive(Clone, Copy)]
        #[repr(transparent)]
        struct $name($raw);

        impl std::fmt::Debug for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                let mut numbers = [0.0; $count];
                self.store(&mut numbers);
                std::fmt::Debug::fmt(&numbers, f)
            }
        }

        impl std::ops::Add for $name {
            type Output = Self;
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                // SAFETY: see the module.
                Self(unsafe { $add(self.0, other.0) })
            }
        }

        impl std::ops::Sub for $name {
            type Output = Self;
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                // SAFETY: see the module.
                Self(unsafe { $sub(self.0, other.0) })
            }
        }

        impl std::ops::Mul for $name {
            type Output = Self;
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                // SAFETY: see the module.
                Self(unsafe { $mul(self.0, other.0) })
            }
        }

        impl std::ops::Neg for $name {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                // SAFETY: see the module.
                Self(unsafe { $neg!(self.0) })
            }
        }

        impl crate::Scalar for $name {
            #[inline(always)]
            fn mul_add(self, b: Self, c: Self) -> Self {
                // SAFETY: see the module.
                Self(unsafe { $fma!(self.0, b.0, c.0) })
            }

            #[inline(always)]
            fn neg_mul_add(self, b: Self, c: Self) -> Self {
                // SAFETY: see the module.
                Self(unsafe { $fnma!(self.0, b.0, c.0) })
            }
        }

        impl crate::Lift<f64> for $name {
            #[inline(always)]
            fn lift(constant: f64) -> Self {
                // SAFETY: see the module.
                Self(unsafe { $splat(constant) })
            }
        }
    };
}

pub(super) use arithmetic;
