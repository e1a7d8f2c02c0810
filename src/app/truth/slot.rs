//! A picture that is being made, or is finished.

use crate::gpu::Texture;

/// What is kept of a picture: everything while it is made, then the picture alone.
#[derive(Debug, Default)]
pub(super) enum Slot<T> {
    #[default]
    Empty,
    Working(Box<T>),
    Finished(Texture),
}

impl<T> Slot<T> {
    pub(super) fn is_begun(&self) -> bool {
        !matches!(self, Self::Empty)
    }

    pub(super) fn finish(&mut self, display: impl FnOnce(T) -> Texture) {
        *self = match std::mem::take(self) {
            Self::Working(work) => Self::Finished(display(*work)),
            other => other,
        };
    }

    pub(super) fn display<'a>(&'a self, display: impl FnOnce(&'a T) -> Option<&'a Texture>) -> Option<&'a Texture> {
        match self {
            Self::Empty => None,
            Self::Working(work) => display(work),
            Self::Finished(texture) => Some(texture),
        }
    }

    pub(super) fn bytes(&self, bytes: impl FnOnce(&T) -> u64) -> u64 {
        match self {
            Self::Empty => 0,
            Self::Working(work) => bytes(work),
            Self::Finished(texture) => texture.bytes(),
        }
    }
}
