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
            let center = |i: u32| boxes[i as usize][axis][0] * 0.5 + boxes[i as usize][axis][1] * 0.5;
            self.order[start..end].select_nth_unstable_by(middle, |&a, &b| center(a).total_cmp(&center(b)));
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
            (Some(children), other) if other.is_none() || first.end - first.start >= second.end - second.start => {
                for child in children {
                    self.pairs_of(child, b, found);
                }
            }
            (_, Some(children)) => children.iter().for_each(|&child| self.pairs_of(a, child, found)),
            _ => {
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
