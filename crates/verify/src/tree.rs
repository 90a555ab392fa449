//! Tree of boxes.

/// Lower and upper bound along each axis.
pub type Bounds = [[f64; 2]; 3];

/// Maximum number of boxes of a leaf.
const LEAF: usize = 6;

/// Binary tree of boxes, split at the median along the longest axis.
pub struct Tree {
    boxes: Vec<Bounds>,
    /// Numbers of boxes; each node has a range.
    order: Vec<u32>,
    nodes: Vec<Node>,
}

struct Node {
    bounds: Bounds,
    start: usize,
    end: usize,
    /// Both children; `None` for a leaf.
    children: Option<[usize; 2]>,
}

impl Tree {
    /// Tree of numbered boxes.
    pub fn new(boxes: Vec<Bounds>) -> Self {
        let order = (0..boxes.len() as u32).collect();
        let mut tree = Self { boxes, order, nodes: Vec::new() };
        if !tree.boxes.is_empty() {
            tree.build(0, tree.order.len());
        }
        tree
    }

    fn build(&mut self, start: usize, end: usize) -> usize {
        let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
        for own in self.order[start..end].iter().map(|&i| &self.boxes[i as usize]) {
            for k in 0..3 {
                bounds[k] = [bounds[k][0].min(own[k][0]), bounds[k][1].max(own[k][1])];
            }
        }
        let node = self.nodes.len();
        self.nodes.push(Node { bounds, start, end, children: None });
        if end - start > LEAF {
            let width = |k: &usize| bounds[*k][1] - bounds[*k][0];
            let axis = (0..3).max_by(|a, b| width(a).total_cmp(&width(b))).unwrap_or(0);
            let middle = (end - start) / 2;
            let boxes = &self.boxes;
            let twice_center = |i: u32| boxes[i as usize][axis].iter().sum::<f64>();
            self.order[start..end].select_nth_unstable_by(middle, |&a, &b| twice_center(a).total_cmp(&twice_center(b)));
            let children = [self.build(start, start + middle), self.build(start + middle, end)];
            self.nodes[node].children = Some(children);
        }
        node
    }

    /// Calls a function for each pair of boxes that touch.
    pub fn pairs(&self, found: &mut impl FnMut(u32, u32)) {
        if !self.nodes.is_empty() {
            self.pairs_of(0, 0, found);
        }
    }

    fn pairs_of(&self, a: usize, b: usize, found: &mut impl FnMut(u32, u32)) {
        let (first, second) = (&self.nodes[a], &self.nodes[b]);
        if !touch(&first.bounds, &second.bounds) {
            return;
        }
        match (first.children, second.children) {
            (Some([low, high]), _) if a == b => {
                self.pairs_of(low, low, found);
                self.pairs_of(low, high, found);
                self.pairs_of(high, high, found);
            }
            // Both nodes are split in turn.
            (Some(children), _) => children.iter().for_each(|&child| self.pairs_of(b, child, found)),
            (None, Some(_)) => self.pairs_of(b, a, found),
            (None, None) => {
                for (n, &i) in self.order[first.start..first.end].iter().enumerate() {
                    let from = if a == b { first.start + n + 1 } else { second.start };
                    let others = self.order[from..second.end].iter();
                    for &j in others.filter(|&&j| touch(&self.boxes[i as usize], &self.boxes[j as usize])) {
                        found(i, j);
                    }
                }
            }
        }
    }

    /// Calls a function for each box that contains a point.
    pub fn around(&self, point: &[f64; 3], found: &mut impl FnMut(u32)) {
        let place = point.map(|x| [x, x]);
        let mut open = if self.nodes.is_empty() { Vec::new() } else { vec![0] };
        while let Some(node) = open.pop().map(|node: usize| &self.nodes[node]) {
            if !touch(&node.bounds, &place) {
                continue;
            }
            if let Some(children) = node.children {
                open.extend(children);
                continue;
            }
            let inside = self.order[node.start..node.end].iter();
            inside.filter(|&&i| touch(&self.boxes[i as usize], &place)).for_each(|&i| found(i));
        }
    }
}

fn touch(a: &Bounds, b: &Bounds) -> bool {
    (0..3).all(|k| a[k][0] <= b[k][1] && b[k][0] <= a[k][1])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Boxes with numbers below 1, from a linear congruential generator of Knuth.
    fn random_boxes(count: usize, width: f64) -> Vec<Bounds> {
        let mut state = 5_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / f64::from(1 << 24)
        };
        (0..count).map(|_| [0; 3].map(|_| [random(), width * random()]).map(|[low, by]| [low, low + by])).collect()
    }

    #[test]
    fn pairs_and_points_are_those_of_all_boxes() {
        for (count, width) in [(0, 1.0), (1, 1.0), (6, 0.6), (7, 0.6), (40, 0.3), (300, 0.1), (300, 0.0)] {
            let boxes = random_boxes(count, width);
            let all = (0..count).flat_map(|i| (i + 1..count).map(move |j| (i, j)));
            let meets = |&(i, j): &(usize, usize)| {
                (0..3).all(|k| boxes[i][k][0].max(boxes[j][k][0]) <= boxes[i][k][1].min(boxes[j][k][1]))
            };
            let expected: Vec<(usize, usize)> = all.filter(meets).collect();
            let tree = Tree::new(boxes.clone());
            let mut found = Vec::new();
            tree.pairs(&mut |i, j| found.push((i.min(j) as usize, i.max(j) as usize)));
            found.sort_unstable();
            assert_eq!(found, expected, "{count}");
            for corner in boxes.iter().map(|b| b.map(|[_, high]| high)) {
                let contains = |i: &usize| (0..3).all(|k| boxes[*i][k][0] <= corner[k] && corner[k] <= boxes[*i][k][1]);
                let mut found = Vec::new();
                tree.around(&corner, &mut |i| found.push(i as usize));
                found.sort_unstable();
                assert_eq!(found, (0..count).filter(contains).collect::<Vec<_>>(), "{count}");
            }
        }
    }

    #[test]
    fn leaves_have_six_boxes_at_most() {
        for (count, nodes) in [(1, 1), (6, 1), (7, 3), (12, 3), (13, 5)] {
            assert_eq!(Tree::new(random_boxes(count, 0.1)).nodes.len(), nodes, "{count}");
        }
    }

    /// Leaves that overlap would cost time.
    #[test]
    fn a_row_of_boxes_is_split_along_its_axis() {
        for (axis, from, across) in [(0, -32.0, 5000.0), (1, -32.0, 5000.0), (2, -32.0, 5000.0), (1, 9000.0, 1.0)] {
            let row = (0..64).map(|i| {
                let low = from + f64::from(i * 37 % 64);
                let mut own = [[across, across + 0.5]; 3];
                own[axis] = [low, low + 0.75];
                own
            });
            let tree = Tree::new(row.collect());
            let mut leaves: Vec<[f64; 2]> =
                tree.nodes.iter().filter(|node| node.children.is_none()).map(|node| node.bounds[axis]).collect();
            leaves.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
            assert_eq!(leaves.len(), 16);
            assert!(leaves.windows(2).all(|pair| pair[0][1] < pair[1][0]), "{leaves:?}");
        }
    }
}
