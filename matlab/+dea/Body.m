function body = Body(varargin)
  % Nodes of a dea.Solid that move as one, as a struct; several bodies are an array of them.
  %
  %   dea.Body('centre_m', [0 0 0], 'nodes', NODES)
  %
  % Options: 'centre_m' what it turns about; 'low_m', 'high_m' its nodes lie in that box; 'curve'
  % on, above and below that physical curve of the .msh file; 'nodes' these only: rows of points_m,
  % counted from 1, or true for each.
  body = dea.options(struct('centre_m', [0 0 0], 'low_m', [], 'high_m', [], 'curve', '', ...
                            'nodes', []), varargin);
  if ~isempty(body.low_m) || ~isempty(body.high_m)
    [body.low_m, body.high_m] = dea.corners(body.low_m, body.high_m);
  end
  if islogical(body.nodes)
    body.nodes = find(body.nodes);
  end
  body.nodes = double(body.nodes(:));
end
