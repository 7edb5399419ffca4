//! Atlas of a material in a tile: rectangles of its textures around the charts, side by side.

use super::charts::Chart;
use super::encode::Texels;
use super::pack::{Packing, Rectangle, join, pack};

/// Texels around each rectangle, which filters mix in at its sides.
const GUTTER: u32 = 2;

/// Atlas of a material: where its rectangles come from and where they are. All its textures are cut
/// alike, smaller ones by a power of two smaller.
#[derive(Debug)]
pub(super) struct Atlas {
    /// Size of the halved texture that rectangles are of.
    source: [u32; 2],
    /// Rectangles of that texture, without their gutters.
    parts: Vec<Rectangle>,
    packing: Packing,
    /// Number of texels on each side of a rectangle.
    gutter: u32,
    /// Rectangle of each chart.
    part_of: Vec<usize>,
}

impl Atlas {
    /// Packs the rectangles of charts of a texture that has this size. Their sides and gutters are
    /// multiples of `grain` texels, so that they are whole in textures smaller by that factor.
    pub fn pack(charts: &[&Chart], source: [u32; 2], grain: u32) -> Self {
        let gutter = GUTTER * grain;
        let around: Vec<Rectangle> =
            charts.iter().map(|chart| texels_around(chart, source, grain)).collect();
        let (parts, part_of) = join(&around, gutter);
        let sizes: Vec<[u32; 2]> =
            parts.iter().map(|part| part.size().map(|side| side + 2 * gutter)).collect();
        Self { source, packing: pack(&sizes), parts, gutter, part_of }
    }

    /// Returns the size of the texture that it is for, as it was halved.
    pub fn source(&self) -> [u32; 2] {
        self.source
    }

    /// Returns the width and height.
    pub fn size(&self) -> [u32; 2] {
        self.packing.size
    }

    /// Returns the texture coordinates of a point of a chart, given those that it had.
    pub fn map(&self, chart: usize, shift: [f64; 2], [u, v]: [f32; 2]) -> [f32; 2] {
        let part = self.part_of[chart];
        let [low, at] = [self.parts[part].low, self.packing.at[part]];
        // Texels are counted from the top, texture coordinates from the bottom.
        let from_top = [f64::from(u) - shift[0], 1.0 - (f64::from(v) - shift[1])];
        let [x, y] = [0, 1].map(|axis| {
            let texel = from_top[axis] * f64::from(self.source[axis]) - f64::from(low[axis]);
            let texel = texel + f64::from(at[axis] + self.gutter);
            (texel / f64::from(self.size()[axis])).clamp(0.0, 1.0)
        });
        [x as f32, (1.0 - y) as f32]
    }

    /// Cuts the rectangles out of a texture, `factor` times smaller, which divides the grain. Texels
    /// between them are `blank`.
    pub fn cut(&self, texture: &Sampled<'_>, factor: u32, blank: [u8; 4]) -> Texels {
        let size = self.size().map(|side| side / factor);
        let mut rgba = vec![blank; size[0] as usize * size[1] as usize];
        for (part, at) in self.parts.iter().zip(&self.packing.at) {
            let [columns, rows] = [0, 1].map(|axis| self.places(part, axis, texture, factor));
            let first = |row: usize| {
                let y = (at[1] / factor) as usize + row;
                y * size[0] as usize + (at[0] / factor) as usize
            };
            for (row, &y) in rows.iter().enumerate() {
                let texels = &mut rgba[first(row)..][..columns.len()];
                let own = texels.iter_mut().zip(&columns);
                own.for_each(|(texel, &x)| *texel = texture.at(x, y));
            }
        }
        Texels { size, rgba }
    }

    /// Returns the places along an axis, in texels of a texture, of the texels of a rectangle and
    /// its gutters.
    fn places(
        &self,
        part: &Rectangle,
        axis: usize,
        texture: &Sampled<'_>,
        factor: u32,
    ) -> Vec<Place> {
        let first = f64::from(part.low[axis]) - f64::from(self.gutter);
        let scale = f64::from(texture.size[axis]) / f64::from(self.source[axis]);
        let middle = |i: u32| first + (f64::from(i) + 0.5) * f64::from(factor);
        let texels = (part.size()[axis] + 2 * self.gutter) / factor;
        (0..texels).map(|i| Place::new(middle(i) * scale, texture.size[axis])).collect()
    }
}

/// Returns the rectangle of the texels that a chart is on, with at least one texel.
fn texels_around(chart: &Chart, source: [u32; 2], grain: u32) -> Rectangle {
    let [low, high] = chart.bounds;
    // From the top: the least is where v is greatest.
    let [low, high] = [[low[0], 1.0 - high[1]], [high[0], 1.0 - low[1]]];
    let along = |axis: usize| {
        let end = source[axis].next_multiple_of(grain);
        let texel = |x: f64| x.clamp(0.0, 1.0) * f64::from(source[axis]);
        let low = (texel(low[axis]) as u32 / grain * grain).min(end - grain);
        let high = (texel(high[axis]).ceil() as u32).next_multiple_of(grain);
        [low, high.clamp(low + grain, end)]
    };
    let [x, y] = [along(0), along(1)];
    Rectangle { low: [x[0], y[0]], high: [x[1], y[1]] }
}

/// Place between two texels of a row or column.
#[derive(Clone, Copy, Debug)]
struct Place {
    texels: [u32; 2],
    /// Part of the second, in 256ths.
    part: u32,
}

impl Place {
    /// Returns the place at a distance from the start, at most the middle of the first or last texel.
    fn new(at: f64, length: u32) -> Self {
        let within = (at - 0.5).clamp(0.0, f64::from(length - 1));
        let fine = (within * 256.0).round() as u64;
        let low = (fine >> 8) as u32;
        Self { texels: [low, (low + 1).min(length - 1)], part: (fine & 255) as u32 }
    }
}

/// Texels of a texture that are sampled.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sampled<'a> {
    pub size: [u32; 2],
    pub texels: &'a [[u8; 4]],
}

impl Sampled<'_> {
    /// Blends the texels around a place; at the middle of one, it is that.
    fn at(&self, x: Place, y: Place) -> [u8; 4] {
        let texel = |x: u32, y: u32| self.texels[y as usize * self.size[0] as usize + x as usize];
        if x.part == 0 && y.part == 0 {
            return texel(x.texels[0], y.texels[0]);
        }
        let four = y.texels.map(|y| x.texels.map(|x| texel(x, y)));
        std::array::from_fn(|channel| {
            let blend = |a: u32, b: u32, part: u32| a * (256 - part) + b * part;
            let row = |row: [[u8; 4]; 2]| {
                blend(u32::from(row[0][channel]), u32::from(row[1][channel]), x.part)
            };
            ((blend(row(four[0]), row(four[1]), y.part) + (1 << 15)) >> 16) as u8
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(low: [f64; 2], high: [f64; 2]) -> Chart {
        Chart { label: 0, bounds: [low, high], shift: [0.0; 2] }
    }

    /// Texels whose red and green are their column and row.
    fn coded(size: [u32; 2]) -> Vec<[u8; 4]> {
        let texels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
        texels.map(|(x, y)| [x as u8, y as u8, 7, 255]).collect()
    }

    fn charts() -> [Chart; 3] {
        [
            chart([0.0, 0.0], [0.2, 0.3]),
            chart([0.61, 0.42], [0.83, 0.99]),
            chart([0.5, 0.03], [0.5, 0.03]),
        ]
    }

    #[test]
    fn the_texel_at_a_point_of_a_chart_is_the_one_it_was() {
        let charts = charts();
        let size = [200, 150];
        let texels = coded(size);
        for grain in [1, 4] {
            let atlas = Atlas::pack(&charts.iter().collect::<Vec<_>>(), size, grain);
            let cut = atlas.cut(&Sampled { size, texels: &texels }, 1, [0; 4]);
            assert_eq!(cut.size, atlas.size());
            for (i, chart) in charts.iter().enumerate() {
                let [low, high] = chart.bounds;
                for step in 0..=10 {
                    let part = f64::from(step) / 10.0;
                    let uv =
                        [0, 1].map(|axis| (low[axis] + part * (high[axis] - low[axis])) as f32);
                    let texel = |[u, v]: [f32; 2], size: [u32; 2]| {
                        // Just inside of texels whose side this is.
                        let at = [f64::from(u), 1.0 - f64::from(v)];
                        [0, 1].map(|axis| at[axis] * f64::from(size[axis]))
                    };
                    let before = texel(uv, size);
                    let after = texel(atlas.map(i, [0.0; 2], uv), cut.size);
                    for corner in [[-1.5, -1.5], [0.0, 0.0], [1.5, 1.5]] {
                        let [x, y] = [0, 1].map(|k| (after[k] + corner[k] + 1e-3).floor() as u32);
                        let found = cut.rgba[(y * cut.size[0] + x) as usize];
                        let [x, y] = [0, 1].map(|k| {
                            let texel = (before[k] + corner[k] + 1e-3).floor();
                            texel.clamp(0.0, f64::from(size[k] - 1)) as u8
                        });
                        assert_eq!(found, [x, y, 7, 255], "chart {i}, {uv:?}, {corner:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_smaller_texture_is_cut_alike() {
        let charts = charts();
        let atlas = Atlas::pack(&charts.iter().collect::<Vec<_>>(), [200, 152], 4);
        let size = [50, 38];
        let cut = atlas.cut(&Sampled { size, texels: &coded(size) }, 4, [0; 4]);
        assert_eq!(cut.size.map(|side| 4 * side), atlas.size());
        for (i, chart) in charts.iter().enumerate() {
            let middle = [0, 1].map(|k| (chart.bounds[0][k] + chart.bounds[1][k]) as f32 / 2.0);
            let mapped = atlas.map(i, [0.0; 2], middle);
            let texel = |[u, v]: [f32; 2], size: [u32; 2]| {
                let at = [f64::from(u), 1.0 - f64::from(v)];
                [0, 1].map(|axis| (at[axis] * f64::from(size[axis]) + 1e-4) as u32)
            };
            let [x, y] = texel(mapped, cut.size);
            let [from_x, from_y] = texel(middle, size).map(|x| x as u8);
            assert_eq!(cut.rgba[(y * cut.size[0] + x) as usize], [from_x, from_y, 7, 255]);
        }
    }

    #[test]
    fn textures_of_any_other_size_are_blended() {
        let whole = chart([0.0; 2], [1.0; 2]);
        let atlas = Atlas::pack(&[&whole], [64, 64], 1);
        let texels: Vec<[u8; 4]> = (0..100).map(|i| [(i % 10 * 20) as u8, 0, 0, 255]).collect();
        let cut = atlas.cut(&Sampled { size: [10, 10], texels: &texels }, 1, [0; 4]);
        let row: Vec<u8> = cut.rgba[..68].iter().map(|texel| texel[0]).collect();
        assert!(row.is_sorted() && row[0] == 0 && row[67] == 180, "{row:?}");
        assert!(row.windows(2).all(|pair| pair[1] - pair[0] <= 4), "{row:?}");
    }
}
