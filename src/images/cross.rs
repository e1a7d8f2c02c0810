//! Six faces of a cube as one picture.

/// Column and row of each face, in the order px, nx, py, ny, pz, nz: a cross that lies, folded along the edges of `pz`.
const PLACES: [[usize; 2]; 6] = [[2, 1], [0, 1], [1, 0], [1, 2], [1, 1], [3, 1]];

/// Lays six square faces of `side` pixels out as a cross of 4 × 3 faces; `blank` fills the corners.
///
/// Faces that are shorter than they should be leave their rest blank.
pub fn cross<T: Copy>(faces: &[Vec<T>; 6], side: usize, blank: T) -> ([usize; 2], Vec<T>) {
    let width = 4 * side;
    let mut whole = vec![blank; width * 3 * side];
    for (face, [column, row]) in faces.iter().zip(PLACES) {
        for (y, line) in face.chunks_exact(side.max(1)).take(side).enumerate() {
            let start = (row * side + y) * width + column * side;
            whole[start..start + side].copy_from_slice(line);
        }
    }
    ([width, 3 * side], whole)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_lie_where_they_fold() {
        let faces: [Vec<u8>; 6] = [1, 2, 3, 4, 5, 6].map(|face| vec![face; 4]);
        let (size, whole) = cross(&faces, 2, 0);
        assert_eq!(size, [8, 6]);
        let row = |y: usize| &whole[8 * y..8 * y + 8];
        assert_eq!(row(0), [0, 0, 3, 3, 0, 0, 0, 0], "up");
        assert_eq!(row(2), [2, 2, 5, 5, 1, 1, 6, 6], "west, north, east, south");
        assert_eq!(row(5), [0, 0, 4, 4, 0, 0, 0, 0], "down");
    }
}
